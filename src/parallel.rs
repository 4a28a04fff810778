//! Work over all cores, with results in order.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Does `work` for 0..`count` on `threads` threads, each with its own tools from `tools`, and hands each result to `take` in
/// order, as early as order allows: the same calls whatever the number of threads is.
pub(crate) fn in_order<T, R: Send>(
    count: usize,
    threads: usize,
    tools: impl Fn() -> T + Sync,
    work: impl Fn(&mut T, usize) -> R + Sync,
    mut take: impl FnMut(R),
) {
    let next = AtomicUsize::new(0);
    let (sender, results) = mpsc::channel::<(usize, R)>();
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, count.max(1)) {
            let (sender, next, tools, work) = (sender.clone(), &next, &tools, &work);
            scope.spawn(move || {
                let mut tools = tools();
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    // Nobody takes results any more only when the others have failed.
                    if index >= count || sender.send((index, work(&mut tools, index))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut early = BTreeMap::new();
        let mut due = 0;
        for (index, result) in results {
            early.insert(index, result);
            while let Some(result) = early.remove(&due) {
                take(result);
                due += 1;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_each_once() {
        for threads in [1, 2, 7] {
            for count in [0, 1, 500] {
                let mut taken = Vec::new();
                in_order(
                    count,
                    threads,
                    || 0,
                    |calls: &mut usize, index| {
                        *calls += 1;
                        // The first of a few take longest.
                        (0..(count - index) * 50)
                            .fold(index, |x, i| std::hint::black_box(x ^ i) ^ i)
                    },
                    |result| taken.push(result),
                );
                assert_eq!(taken, (0..count).collect::<Vec<_>>());
            }
        }
    }
}
