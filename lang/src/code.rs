//! Diagnostic codes. Each has a page in `lang/diagnostics/`, which `soifra explain` shows.

macro_rules! codes {
    ($($name:ident = $code:literal, $title:literal;)*) => {
        $(#[doc = $title] pub const $name: &str = $code;)*
        /// Every code of the language with its general title.
        pub const CODES: &[(&str, &str)] = &[$(($code, $title),)*];
    };
}

codes! {
    SYNTAX = "S0101", "Something stands where it cannot";
    NESTING = "S0102", "Nested too deep";
    LONG_NAME = "S0103", "A name is too long";
    NUMBER_RANGE = "S0104", "A number is too large";
    EDITION = "S0105", "Unknown language edition";

    UNKNOWN_NAME = "S0201", "Unknown name";
    DUPLICATE = "S0202", "A name is declared twice";
    AMBIGUOUS = "S0203", "A name could mean several things";
    MISSING_IMPORT = "S0204", "An import cannot be read";
    IMPORT_CYCLE = "S0205", "Files import each other";
    UNKNOWN_TYPE = "S0206", "Unknown type";
    UNKNOWN_FIELD = "S0207", "No such field or function";
    RECURSION = "S0208", "Something is defined by itself";

    UNIT = "S0301", "Unknown unit";
    MISMATCH = "S0302", "A value has the wrong type";
    OPERANDS = "S0303", "Operands do not go together";
    ARGUMENTS = "S0304", "Wrong arguments";
    ABSENCE = "S0305", "Absence is not handled";
    NOT_EXHAUSTIVE = "S0306", "A match leaves a case open";
    NOT_CONSTANT = "S0307", "A value must be known before the run";
    NOT_FINITE = "S0308", "A constant is not a finite number";
    CANNOT_INFER = "S0309", "The type cannot be told from here";
    RANGE = "S0310", "A value is outside what is possible";

    UNKNOWN_PLATFORM = "S0401", "Unknown platform";
    LACKS_SENSOR = "S0402", "The platform lacks a sensor";
    LACKS_ACTUATOR = "S0403", "The platform lacks an actuator";
    PORT_TYPE = "S0404", "A port has another type on the platform";
    NO_SAFE_ACTION = "S0405", "A platform without a safe action";
    UNKNOWN_MODEL = "S0406", "Unknown model or role";
    INCOMPLETE_PLATFORM = "S0407", "A platform lacks a part";
    NO_STEP_CLOCK = "S0408", "Something needs a step clock";
    NO_PLACE = "S0409", "A host is nowhere";

    SEVERAL_WRITERS = "S0501", "Several units command one actuator without an arbiter";
    UNREACHABLE_STATE = "S0502", "A state that cannot be reached";
    UNREACHABLE_RULE = "S0503", "A rule that can never fire";
    ARBITER_SOURCE = "S0504", "An arbiter's sources do not fit";
    UNREAD_TOPIC = "S0505", "Messages that nobody reads";
    UNPUBLISHED_TOPIC = "S0506", "A topic that nobody publishes on";
    UNUSED_ACTUATOR = "S0507", "An actuator port that nobody commands";
    UNRAISED_EVENT = "S0508", "An event that nobody raises, or nobody waits for";
    UNREACHABLE_NODE = "S0509", "A plan node that can never be ticked";
    UNBOUNDED = "S0510", "An activation has no acceptable bound";
    TIMING = "S0511", "Declared timing contradicts itself";
    NO_EFFECT = "S0512", "A unit without effect";
    FULL_LIST = "S0513", "An item for a list that is full";
    ANYTIME = "S0514", "Anytime work that cannot be paid for";
    LATE = "S0515", "A deadline that can be missed";
    OVERLOAD = "S0516", "A core that cannot keep up";
    UNLIMITED = "S0517", "A load without a limit";
    MESSAGE = "S0518", "A message that the protocol does not have";
    STUCK = "S0519", "A conversation that can get stuck";
    PROTOCOL = "S0520", "A protocol that cannot be followed";
    NOBODY = "S0521", "A conversation without a partner";

    TRUTH = "S0601", "Truth in a behaviour";
    FRAMES = "S0602", "Frames are mixed";
    RANDOM = "S0603", "A draw where none is allowed";
    BELIEF = "S0604", "A robot reads what it cannot know";

    NO_MISSION = "S0701", "A file without a mission";
    NO_ROBOT = "S0702", "A mission without a robot";
    NO_GOAL = "S0703", "A mission without a goal";
    NO_AGENT = "S0704", "Nobody works on a sub-goal";
    NO_PLAN = "S0705", "A sub-goal that nothing achieves";
    MISSING_MEMBER = "S0706", "A mission lacks a member";
    PLACEMENT = "S0707", "Robots or things overlap at the start";
    EXCLUSIVE = "S0708", "An exclusive agent is wanted twice";
    TEST = "S0709", "A test cannot be run";
    NO_CAPABLE = "S0710", "No agent is capable of a sub-goal";
    NOT_AVAILABLE = "S0711", "Capable agents are not available";
    FAULT = "S0712", "A fault that cannot happen";

    GRAPH = "S0801", "A damaged graph";
}
