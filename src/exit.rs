//! Exit codes: what a shell, a build or a cluster's job array can tell from a finished command.

use std::process::ExitCode;

/// How a command ended. The order is from good to bad: of several runs the worst counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// Done as asked.
    Success,
    /// A run failed or ran out of time, a replay or golden differs, a file is not in form.
    Failed,
    /// The input is wrong; nothing was started.
    WrongInput,
    /// A run was cut short by its platform, a safe action, or a trace that stopped being writable.
    Aborted,
    /// A defect of soifra itself (the number is sysexits' EX_SOFTWARE).
    Internal,
    /// The operator stopped it; what was recorded is kept.
    Interrupted,
}

impl Exit {
    /// The number the process ends with.
    pub fn code(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::Failed => 1,
            Exit::WrongInput => 2,
            Exit::Aborted => 3,
            Exit::Internal => 70,
            Exit::Interrupted => 130,
        }
    }

    /// What a run with this outcome ends with.
    pub fn of_outcome(outcome: &str) -> Exit {
        match outcome {
            "success" => Exit::Success,
            "failed" | "timeout" => Exit::Failed,
            "interrupted" => Exit::Interrupted,
            _ => Exit::Aborted,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(e: Exit) -> ExitCode {
        ExitCode::from(e.code())
    }
}
