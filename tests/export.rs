//! What is written is read back: by this crate's readers, and the log by the `mcap` crate.

use proptest::prelude::*;
use serde_json::Value;
use undulate::{
    Derivative, Joints, Motion, PlayMotion, Result, Spline, StartPosture, State, Wave, Waypoint,
    Waypoints, shipped, testing,
};

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files, json};

fn spline(waypoints: &Waypoints) -> Spline {
    Spline::new(waypoints, StartPosture::Given).unwrap()
}

/// What each text format makes of waypoints.
fn through(waypoints: &Waypoints) -> [(&'static str, Result<Waypoints>); 3] {
    let yaml = waypoints.to_play_motion("wave");
    [
        (
            "csv",
            waypoints
                .to_csv()
                .and_then(|text| Waypoints::from_csv("m", &text, false)),
        ),
        (
            "json",
            waypoints
                .to_json()
                .and_then(|text| Waypoints::from_json("m", &text)),
        ),
        (
            "yaml",
            yaml.and_then(|text| PlayMotion::read("m", &text)?.choose(None)),
        ),
    ]
}

/// The largest distance of two motions of as many joints at so many instants.
fn apart(a: &impl Motion, b: &impl Motion, instants: usize) -> f64 {
    let mut states = [
        State::zeros(a.joints().len()),
        State::zeros(a.joints().len()),
    ];
    let mut largest: f64 = 0.0;
    for i in 0..=instants {
        // Either may last half a nanosecond less.
        let t = a.duration().min(b.duration()) * i as f64 / instants as f64;
        a.state_into(t, &mut states[0]);
        b.state_into(t, &mut states[1]);
        largest = largest.max((&states[0].position - &states[1].position).amax());
    }
    largest
}

/// A move of two joints with linear, cubic and quintic segments at times of no grid.
fn moves() -> impl Strategy<Value = Waypoints> {
    let row = proptest::array::uniform3(proptest::array::uniform2(-1.5..1.5_f64));
    proptest::collection::vec((0.05..1.0_f64, row, 0..3_usize), 2..9).prop_map(|rows| {
        let mut times = vec![0.0];
        for (gap, ..) in &rows[1..] {
            times.push(times[times.len() - 1] + gap);
        }
        Waypoints::new(
            Joints::new(["a b", "\"c\"/d"]).unwrap(),
            rows.iter()
                .zip(&times)
                .map(|((_, row, given), time)| Waypoint {
                    time: *time,
                    positions: &row[0],
                    velocities: (*given > 0).then_some(&row[1][..]),
                    accelerations: (*given > 1).then_some(&row[2][..]),
                }),
        )
        .unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn a_wave_comes_back_bit_for_bit_and_the_controller_stays_near_it(
        wave in testing::waves(1..=3, 1..=6),
        rate in 1.0..80.0_f64,
    ) {
        let waypoints = Waypoints::sampled(&wave, rate).unwrap();
        let h = wave.period() / (waypoints.len() - 1) as f64;
        prop_assert!(h <= (1.0 + 1e-8) / rate && (waypoints.len() == 2 || 1.0 / rate < 2.0 * h));
        prop_assert_eq!(waypoints.get(0).time, 0.0);
        let last = waypoints.get(waypoints.len() - 1);
        prop_assert!((last.time - wave.period()).abs() <= 0.5e-9);
        for waypoint in waypoints.iter() {
            let state = wave.state(waypoint.time.min(wave.period()));
            prop_assert_eq!(waypoint.positions, state.position.as_slice());
            prop_assert_eq!(waypoint.velocities, Some(state.velocity.as_slice()));
            prop_assert_eq!(waypoint.accelerations, Some(state.acceleration.as_slice()));
        }
        for (format, read) in through(&waypoints) {
            let read = read.unwrap();
            if format != "yaml" {
                prop_assert_eq!(&read, &waypoints);
            }
            let order = if format == "yaml" { 2 } else { 6 };
            let divisor = if format == "yaml" { 8.0 } else { 46080.0 };
            let sum = |j| wave.harmonic_sum(j, order);
            let most = (0..wave.joints().len()).map(sum).fold(0.0, f64::max) * h.powi(order) / divisor;
            let fastest = (0..wave.joints().len()).map(|j| wave.harmonic_sum(j, 1)).fold(0.0, f64::max);
            let found = apart(&wave, &spline(&read), 997);
            prop_assert!(found <= most * (1.0 + 1e-6) + 1e-9 * fastest + 1e-12, "{format}: {found:e} of {most:e}");
        }
    }

    #[test]
    fn a_move_stays_the_same_spline_through_more_waypoints(waypoints in moves(), rate in 0.5..200.0_f64) {
        let before = spline(&waypoints);
        let more = before.resampled(rate).unwrap();
        // Every waypoint is still there, but for the rounding of a quintic's sum, whose terms are up to so many times as large.
        let size = |values: Option<&[f64]>| values.unwrap_or(&[]).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let longest = waypoints.iter().zip(waypoints.iter().skip(1)).map(|(a, b)| b.time - a.time).fold(0.0, f64::max);
        let largest = waypoints.iter().map(|w| {
            32.0 * size(Some(w.positions)) + 16.0 * longest * size(w.velocities) + 4.0 * longest * longest * size(w.accelerations)
        }).fold(0.0, f64::max);
        for waypoint in waypoints.iter() {
            let there = more.iter().find(|w| (w.time - waypoint.time).abs() <= 0.5e-9).unwrap();
            for (a, b) in there.positions.iter().zip(waypoint.positions) {
                prop_assert!((a - b).abs() <= 4.0 * f64::EPSILON * largest);
            }
        }
        for pair in more.iter().zip(more.iter().skip(1)) {
            prop_assert!(pair.1.time - pair.0.time <= 1.0 / rate + 2e-9);
        }
        for (format, read) in through(&more) {
            let read = read.unwrap();
            prop_assert_eq!(read.len(), more.len());
            if format == "yaml" {
                prop_assert!(read.iter().zip(more.iter()).all(|(a, b)| a.positions == b.positions && a.time == b.time));
            } else {
                prop_assert_eq!(&read, &more);
                let after = spline(&read);
                // Half a nanosecond at the largest speed that such waypoints make, some 200 a second.
                let found = apart(&before, &after, 997);
                prop_assert!(found < 1e-6, "{found:e}");
                for joint in 0..2 {
                    let range = |s: &Spline| s.range(joint, Derivative::Position);
                    prop_assert!((range(&before).width() - range(&after).width()).abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn names_and_sizes_that_a_format_cannot_hold_are_refused() {
    let still = |names: [&str; 2], rows: usize| {
        let times: Vec<f64> = (0..rows).map(|n| n as f64).collect();
        Waypoints::new(
            Joints::new(names).unwrap(),
            times.iter().map(|time| Waypoint {
                time: *time,
                positions: &[0.1, 0.2],
                velocities: None,
                accelerations: None,
            }),
        )
        .unwrap()
    };
    for (names, rows, refused) in [
        (["a", "b"], 3, vec![]),
        (["a,b", "c\nd"], 3, vec![]),
        (["12", "null"], 3, vec![]),
        (["a", "time_s"], 3, vec!["csv"]),
        (["a", "time_from_start"], 3, vec!["csv"]),
        (["a", "a/velocity"], 3, vec!["csv"]),
        (["a", "b/acceleration"], 3, vec!["csv"]),
        ([" a", "b"], 3, vec!["csv"]),
        (["a", "b"], 60_000, vec!["yaml"]),
    ] {
        for (format, read) in through(&still(names, rows)) {
            assert_eq!(
                read.is_err(),
                refused.contains(&format),
                "{names:?} {format}"
            );
            if let Ok(read) = read {
                assert_eq!(read, still(names, rows));
            }
        }
    }
    for name in ["", "a b", "a.b", "a\": {"] {
        let error = still(["a", "b"], 2).to_play_motion(name).unwrap_err();
        assert!(error.to_string().contains("letters, digits"), "{error}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
        let wave = wave();
        let error = Waypoints::sampled(&wave, rate).unwrap_err();
        assert!(
            error.to_string().contains("more than 0 and at most"),
            "{error}"
        );
        let moved = spline(&still(["a", "b"], 2));
        assert!(moved.resampled(rate).is_err());
    }
    let error = Waypoints::sampled(&wave(), 1e6).unwrap_err();
    assert!(
        error.to_string().contains("waypoints times joints"),
        "{error}"
    );
}

/// A wave of the demonstrator on `wave_arm`.
fn wave() -> Wave {
    let robot = shipped::robot("wave_arm").unwrap();
    let primitive =
        undulate::FourierMovementPrimitive::learn(&undulate::synthetic(0).unwrap(), 25).unwrap();
    let map = shipped::map("wave_arm_demonstrator").unwrap();
    map.apply(&primitive.mean_wave(), &robot).unwrap()
}

/// Messages in the order of the file.
fn in_order(bytes: &[u8]) -> Vec<mcap::Message<'_>> {
    let stream = mcap::MessageStream::new(bytes).unwrap();
    stream.map(|message| message.unwrap()).collect()
}

/// Messages as the index of each chunk finds them.
fn indexed<'a>(bytes: &'a [u8], summary: &'a mcap::Summary) -> Vec<mcap::Message<'a>> {
    let mut messages = Vec::new();
    for chunk in &summary.chunk_indexes {
        let by_channel = summary.read_message_indexes(bytes, chunk).unwrap();
        let mut entries: Vec<_> = by_channel.into_values().flatten().collect();
        entries.sort_by_key(|entry| entry.offset);
        for entry in &entries {
            messages.push(summary.seek_message(bytes, chunk, entry).unwrap());
        }
    }
    messages
}

#[test]
fn another_reader_finds_every_joint_state_in_the_log() {
    let wave = wave();
    // Of one chunk and of several.
    for rate in [30.0, 2000.0] {
        let waypoints = Waypoints::sampled(&wave, rate).unwrap();
        let bytes = waypoints.to_mcap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let messages = in_order(&bytes);
        assert_eq!(messages.len(), waypoints.len());
        assert_eq!(messages, indexed(&bytes, &summary));
        for (n, (message, waypoint)) in messages.iter().zip(waypoints.iter()).enumerate() {
            assert_eq!(message.channel.topic, "/joint_states");
            assert_eq!(message.channel.message_encoding, "json");
            assert_eq!(message.sequence as usize, n);
            assert_eq!(message.log_time as f64 / 1e9, waypoint.time);
            assert_eq!(message.publish_time, message.log_time);
            let state: Value = serde_json::from_slice(&message.data).unwrap();
            let numbers =
                |key: &str| -> Vec<f64> { serde_json::from_value(state[key].clone()).unwrap() };
            assert_eq!(numbers("position"), waypoint.positions);
            assert_eq!(numbers("velocity"), waypoint.velocities.unwrap());
            let names: Vec<String> = serde_json::from_value(state["name"].clone()).unwrap();
            assert_eq!(names, wave.joints().iter().cloned().collect::<Vec<_>>());
            let stamp = |key: &str| state["header"]["stamp"][key].as_u64().unwrap();
            assert_eq!(
                stamp("sec") * 1_000_000_000 + stamp("nsec"),
                message.log_time
            );
        }
        let schema = messages[0].channel.schema.as_ref().unwrap();
        assert_eq!(schema.name, "sensor_msgs/msg/JointState");
        assert_eq!(schema.encoding, "jsonschema");
        let described: Value = serde_json::from_slice(&schema.data).unwrap();
        for key in ["header", "name", "position", "velocity", "effort"] {
            assert!(described["properties"][key]["type"].is_string(), "{key}");
        }
        let statistics = summary.stats.as_ref().unwrap();
        assert_eq!(statistics.message_count, waypoints.len() as u64);
        assert_eq!(statistics.chunk_count as usize, summary.chunk_indexes.len());
        assert_eq!(statistics.chunk_count > 1, rate > 1000.0);
        assert_eq!(statistics.message_start_time, 0);
        assert_eq!(
            statistics.message_end_time,
            messages.last().unwrap().log_time
        );
        // Each offset leads to records of its kind.
        let footer = mcap::read::footer(&bytes).unwrap();
        let records = &bytes[footer.summary_offset_start as usize..];
        let mut kinds = Vec::new();
        for record in mcap::read::LinearReader::sans_magic(records) {
            if let mcap::records::Record::SummaryOffset(offset) = record.unwrap() {
                assert_eq!(bytes[offset.group_start as usize], offset.group_opcode);
                kinds.push(offset.group_opcode);
            }
        }
        assert_eq!(kinds, [3, 4, 11, 8]);
    }
}

#[test]
fn a_log_that_is_cut_short_is_noticed() {
    let bytes = Waypoints::sampled(&wave(), 30.0).unwrap().to_mcap();
    for cut in [1, 8, 30, bytes.len() / 2] {
        assert!(mcap::Summary::read(&bytes[..bytes.len() - cut]).is_err());
    }
}

#[test]
fn the_verb_writes_each_format_and_check_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("wave.json"), wave().to_json()).unwrap();
    std::fs::write(at.join("same.toml"), "").unwrap();
    let export = |file: &str| {
        let same = ["--robot", "wave_arm", "--map", "same.toml", "--rate", "100"];
        let arguments = ["export", "wave.json"].into_iter().chain(same);
        json(at, &arguments.chain(["-o", file]).collect::<Vec<_>>())
    };
    let period = wave().period();
    for file in ["out.csv", "out.json", "2nd-out.yaml", "out.mcap"] {
        let report = export(file);
        assert_eq!(report["file"], file);
        assert_eq!(report["waypoints"], 1 + (100.0 * period).ceil() as u64);
        let last = report["duration_s"].as_f64().unwrap();
        assert!((last - period).abs() < 1e-9);
        let departs = report["departs_from_wave_rad"].as_f64();
        match file {
            "out.mcap" => assert!(departs.is_none()),
            "2nd-out.yaml" => assert!(departs.unwrap() < 1e-2),
            _ => assert!(departs.unwrap() < 1e-6),
        }
    }
    let line = "export wave.json --robot wave_arm --map same.toml --rate 50 -o again.csv";
    let output = program::run(at, &line.split(' ').collect::<Vec<_>>());
    let warned = program::text(&output.stderr);
    assert!(warned.contains("starts and ends in motion"), "{warned}");
    let clearance = |file: &str, options: &[&str]| {
        let fixed = ["check", file, "--robot", "wave_arm"];
        let report = json(at, &[&fixed, options].concat());
        report["collision"]["clearance_m"][0].as_f64().unwrap()
    };
    let of_wave = clearance("wave.json", &["--map", "same.toml"]);
    for file in ["out.csv", "out.json", "2nd-out.yaml"] {
        let of_move = clearance(file, &[]);
        assert!(
            (of_move - of_wave).abs() < 1e-3,
            "{file}: {of_move} {of_wave}"
        );
    }
    let yaml = std::fs::read(at.join("2nd-out.yaml")).unwrap();
    let motions = PlayMotion::read("m", &yaml).unwrap();
    assert_eq!(motions.iter().next().unwrap().0, "2nd_out");
    // A move, from one format to another, with a joint that it does not name.
    std::fs::write(at.join("nod.csv"), "time_s,elbow\n0.5,10\n2,20\n").unwrap();
    let nod = "export nod.csv --degrees --robot wave_arm --at shoulder_roll=10deg --from-first-waypoint --rate 2 --format json -o nod.out";
    let report = json(at, &nod.split(' ').collect::<Vec<_>>());
    assert_eq!(report["held_still"].as_array().unwrap().len(), 5);
    let read = Waypoints::from_json("m", &std::fs::read(at.join("nod.out")).unwrap()).unwrap();
    let times: Vec<f64> = read.iter().map(|w| w.time).collect();
    assert_eq!(times, [0.0, 0.5, 1.0, 1.5, 2.0]);
    let elbow = read.joints().index("elbow").unwrap();
    let middle = read.get(3).positions[elbow];
    assert!((middle - (50f64 / 3.0).to_radians()).abs() < 1e-15);
    let roll = read.joints().index("shoulder_roll").unwrap();
    assert_eq!(read.get(3).positions[roll], 10f64.to_radians());
}

#[test]
fn what_cannot_be_exported_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("wave.json"), wave().to_json()).unwrap();
    std::fs::write(at.join("same.toml"), "").unwrap();
    std::fs::write(at.join("bad.csv"), "time_s,hip\n0,0\n1,0\n").unwrap();
    let two = "n: {ros__parameters: {motions: {a: {joints: [elbow], positions: [0, 1], times_from_start: [0, 1]}, b: {joints: [elbow], positions: [0, 1], times_from_start: [0, 1]}}}}";
    std::fs::write(at.join("two.yaml"), two).unwrap();
    let before = files(at);
    for (code, line, words) in [
        (
            2,
            "wave.json --map same.toml --rate 0 -o out.csv",
            "a rate of 0 Hz",
        ),
        (
            2,
            "wave.json --map same.toml --rate -3 -o out.csv",
            "a rate of -3 Hz",
        ),
        (
            2,
            "wave.json --map same.toml --rate inf -o out.csv",
            "a rate of inf Hz",
        ),
        (
            2,
            "wave.json --map same.toml --rate 2e6 -o out.csv",
            "at most 1e6",
        ),
        (
            2,
            "wave.json --map same.toml --rate ten -o out.csv",
            "invalid value 'ten'",
        ),
        (
            2,
            "wave.json --map same.toml --rate 10 -o out.bag",
            "--output out.bag, expected --format",
        ),
        (
            2,
            "wave.json --map same.toml --rate 10 --name x -o out.csv",
            "--name for a format without names",
        ),
        (
            2,
            "wave.json --map same.toml --rate 10 --name a.b -o out.yaml",
            "a motion called `a.b`",
        ),
        (
            2,
            "wave.json --map same.toml --rate 10 --degrees -o out.csv",
            "--degrees for a wave",
        ),
        (
            1,
            "wave.json --map same.toml --rate 1e6 -o out.csv",
            "waypoints times joints",
        ),
        (
            1,
            "wave.json --map same.toml --rate 3000 -o out.yaml",
            "as YAML of play_motion2, written:",
        ),
        (1, "bad.csv --rate 10 -o out.csv", "no joint `hip`"),
        (1, "missing.csv --rate 10 -o out.csv", "missing.csv"),
        (1, "two.yaml --rate 10 -o out.csv", "2 motions"),
        (
            2,
            "two.yaml --all-motions --rate 10 -o out.csv",
            "two.yaml: 2 motions, expected one",
        ),
    ] {
        let line = format!("export {line} --robot wave_arm");
        let error = fails(at, code, &line.split(' ').collect::<Vec<_>>());
        assert!(error.contains(words), "{line}: {error}");
        assert_eq!(files(at), before, "{line}");
    }
    let help = done(at, &["export", "--help"]);
    for word in ["play_motion2", "Foxglove", "--rate", "Examples"] {
        assert!(help.contains(word), "{word}");
    }
}
