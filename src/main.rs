//! The `soifra` binary; everything is in the library.

fn main() -> std::process::ExitCode {
    soifra::main()
}
