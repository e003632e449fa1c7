//! Ctrl-C and SIGTERM: the first asks a run to stop and keeps what was recorded, the second ends the process.

use std::sync::{
    Arc, LazyLock,
    atomic::{AtomicBool, Ordering},
};

static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(false)));

/// The flag that running missions watch. Installs the handler on first use; where that is not
/// possible the system's own handling stays.
pub fn flag() -> Arc<AtomicBool> {
    static INSTALLED: LazyLock<()> = LazyLock::new(|| {
        let stop = Arc::clone(&STOP);
        let _ = ctrlc::set_handler(move || {
            if stop.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(crate::exit::Exit::Interrupted.code()));
            }
        });
    });
    LazyLock::force(&INSTALLED);
    Arc::clone(&STOP)
}

/// Whether somebody asked to stop.
pub fn requested() -> bool {
    STOP.load(Ordering::SeqCst)
}
