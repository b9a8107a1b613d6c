//! The `rodlab` program: hands over to [`rodlab::cli`], which holds the exit-code policy.

fn main() -> std::process::ExitCode {
    rodlab::cli::main()
}
