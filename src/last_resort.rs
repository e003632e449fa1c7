//! What happens when soifra itself is wrong: a diagnostic instead of a backtrace.

use crate::{exit::Exit, output};
use std::panic::PanicHookInfo;

/// Stack of the threads that compile and run: recursion over sources is bounded by the nesting limit,
/// and this is enough for the deepest that passes, in debug builds too.
const STACK: usize = 256 << 20;

/// Runs `work` on a thread with a large stack and turns a panic into diagnostic S9999.
pub fn guarded(work: impl FnOnce() -> Exit + Send + 'static) -> Exit {
    std::panic::set_hook(Box::new(tell));
    match std::thread::Builder::new().name("soifra".into()).stack_size(STACK).spawn(work) {
        Ok(thread) => thread.join().unwrap_or(Exit::Internal),
        Err(e) => {
            output::note(&format!(
                "error[S9014]: the system gives no thread with a stack of {} MB: {e}",
                STACK >> 20
            ));
            Exit::Aborted
        }
    }
}

fn tell(info: &PanicHookInfo<'_>) {
    let what = info.payload();
    let text =
        what.downcast_ref::<&str>().copied().or_else(|| what.downcast_ref::<String>().map(String::as_str));
    let at = info.location().map_or(String::new(), |l| format!(" ({}:{})", l.file(), l.line()));
    output::note(&format!(
        "error[S9999]: soifra met a defect of its own: {}{at}\n  help: this is not your mission's fault; please report it with the command line and the files",
        text.unwrap_or("no message")
    ));
}
