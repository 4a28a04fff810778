//! The `undulate` program: see `undulate --help`.

fn main() -> std::process::ExitCode {
    undulate::cli::main()
}
