//! Models a profile, world or topic can be made of: their roles and signatures.
//!
//! A new sensor, drive or obstacle is one line here and one file in the platforms; no other Rust
//! knows it. The result type is that of a reading or command.

use crate::signature::Signature;
use std::sync::LazyLock;

/// A model: role, signature, documentation.
#[derive(Debug)]
pub struct Model {
    /// The keyword it is declared with.
    pub role: &'static str,
    /// Name, parameters, result.
    pub signature: Signature,
    /// One line.
    pub doc: &'static str,
}

/// Roles whose entries have a name (`sensor ir = …`); all others stand alone (`body = …`).
pub const NAMED_ROLES: &[&str] =
    &["sensor", "actuator", "wall", "obstacle", "region", "mover", "parcel", "material", "topic"];
/// Textures of surfaces that need no material of a world: names of the camera's patterns.
pub const TEXTURES: &[&str] =
    &["plaster", "bricks", "planks", "tiles", "checker", "speckle", "concrete", "carpet"];
/// Roles a platform profile has.
pub const PLATFORM_ROLES: &[&str] =
    &["body", "drive", "cruise", "power", "sensor", "actuator", "safe", "prepare", "finish"];
/// Roles a world has.
pub const WORLD_ROLES: &[&str] =
    &["bounds", "floor", "light", "current", "wall", "obstacle", "region", "mover", "parcel", "material"];
/// Roles a mission or test has besides those of its world.
pub const FAULT_ROLES: &[&str] = &["fault"];

const TABLE: &[(&str, &str, &str)] = &[
    (
        "body",
        "cylinder(radius: Length, height: Length, mass: Mass = 1 kg)",
        "An upright cylinder around the origin of base_link",
    ),
    (
        "drive",
        "differential(wheel_radius: Length, wheel_base: Length, max_speed: Velocity, wheel_acceleration: AngularAcceleration, lag: Duration = 0 s, wheel_error: Distribution<Number> = 0, rotation_error: Distribution<Number> = 0)",
        "Two driven wheels; each follows its speed with a first-order lag and an acceleration limit; errors are relative, the wheel error is drawn once a revolution of the wheel, the rotation error once a turn",
    ),
    (
        "drive",
        "holonomic(max_speed: Velocity, max_turn: AngularVelocity, lag: Duration = 0 s, error: Distribution<Number> = 0)",
        "Moves in any direction and turns at will; the error is relative, drawn once a motion (a stride, or a twist unlike the last)",
    ),
    (
        "drive",
        "quadrotor(max_speed: Velocity, max_climb: Velocity, max_turn: AngularVelocity, max_tilt: Angle, attitude_lag: Duration = 80 ms, velocity_lag: Duration = 400 ms, turn_lag: Duration = 150 ms, drag: Frequency = 0.1 Hz, gust: Distribution<Acceleration> = 0)",
        "Four rotors: it tilts to go somewhere. The attitude is of second order with a natural frequency of 1 / attitude_lag, damped by 0.8; an autopilot holds the commanded speed with a time constant of velocity_lag, and the height; drag is the deceleration by the air for each m/s; a gust is an acceleration along each axis of map, drawn ten times a second",
    ),
    (
        "drive",
        "recorded(file: Text = \"\", rate: Frequency? = none)",
        "What was recorded, not simulated: sensors read the recording, and commands move nothing. `file` is a folder or a numbered pattern of images, a Y4M file or a trace, and `rate` how many images a second it has where it does not tell; both can be given with `--recording` and `--rate`",
    ),
    (
        "drive",
        "submersible(max_speed: Velocity, max_climb: Velocity, max_turn: AngularVelocity, thrust: Vector<base_link, Force>, torque: Torque, added_mass: Vector<base_link, Mass>, inertia: Inertia, linear_drag: Vector<base_link, Quantity<kg/s>>, quadratic_drag: Vector<base_link, Quantity<kg/m>>, linear_turn_drag: Quantity<m2*kg/s/rad> = 0, quadratic_turn_drag: Quantity<m2*kg/rad2> = 0, thruster_lag: Duration = 100 ms, velocity_lag: Duration = 500 ms, turn_lag: Duration = 300 ms)",
        "Thrusters under water, neutrally buoyant and held level. Vectors are ahead, left, up; thrust and torque are the most that the thrusters give, each with a lag of first order, and those for ahead, left and turn share what they have. The mass is that of the body and the water it drags along; inertia is about z, that of the water included; drag counts against the water. An autopilot holds the commanded speed over the ground with the time constants, and the depth; without power it drifts with the current",
    ),
    ("cruise", "speed(of: Velocity)", "How fast the robot usually goes: `robot.cruise_speed`"),
    (
        "sensor",
        "imu(period: Duration, latency: Duration = 0 s, rate_noise: Distribution<AngularVelocity> = 0, rate_bias: Distribution<AngularVelocity> = 0, tilt_noise: Distribution<Angle> = 0) -> Imu",
        "Tilt, and rates about the axes of base_link; noise is drawn for every reading, the bias of each axis once a run",
    ),
    (
        "sensor",
        "flow_odometry(period: Duration, latency: Duration = 0 s, speed_noise: Distribution<Velocity> = 0, scale_error: Distribution<Number> = 0, turn_noise: Distribution<AngularVelocity> = 0, turn_bias: Distribution<AngularVelocity> = 0) -> Odometry",
        "Pose in odom and twist, integrated from the speed over the ground, as a camera that looks down or a Doppler velocity log tells it, and a gyroscope; starts at the origin. The noise is drawn for every reading, the error of the scale and the bias of the gyroscope once a run",
    ),
    (
        "sensor",
        "ideal_pose(period: Duration? = none, latency: Duration = 0 s) -> Pose<map>",
        "The true pose; for abstract robots only. Without a period: at every step",
    ),
    (
        "sensor",
        "discs(range: Length, capacity: Int, period: Duration? = none, latency: Duration = 0 s) -> List<Disc, capacity>",
        "Movers and round obstacles whose rim is within range, nearest first; not robots",
    ),
    (
        "sensor",
        "infrared(bearings: List<Angle, N>, range: Range<Length>, period: Duration, latency: Duration = 0 s, noise: Distribution<Number> = 0, false_alarm: Number = 0, height: Length = 2 cm) -> List<Beam, bearings>",
        "Range by reflected light from the rim of the body, one beam a bearing; noise is relative to the range; `false_alarm` is the chance that a beam with nothing in range reports something anywhere in its range; it sees what is taller than `height`",
    ),
    (
        "sensor",
        "ultrasonic(bearings: List<Angle, N>, range: Range<Length>, cone: Angle, period: Duration, latency: Duration = 0 s, noise: Distribution<Length> = 0, height: Length = 2 cm) -> List<Beam, bearings>",
        "Range to the nearest surface within a cone around each bearing, from the rim of the body; it sees what is taller than `height`",
    ),
    (
        "sensor",
        "laser(beams: Int, field: Range<Angle>, range: Range<Length>, period: Duration, latency: Duration = 0 s, noise: Distribution<Length> = 0, height: Length = 20 cm) -> List<Beam, beams>",
        "A planar scan from the centre of the body, first beam at the low end of the field; it sees what is taller than `height`",
    ),
    (
        "sensor",
        "camera(width: Int, height: Int, field_of_view: Angle, at: Vector<base_link>, period: Duration, latency: Duration = 0 s, tilt: Angle = 0, noise: Number = 0.008, gain: Number = 1, k1: Number = 0, k2: Number = 0, exposure: Duration? = none) -> Image",
        "RGB images of the world from `at` on the robot, looking ahead and `tilt` down; the field of view is that of a row. Noise is the standard deviation of every channel, relative to white; gain is a factor for all that is bright; k1 and k2 are the radial distortion of the lens; `exposure` is how long the shutter is open around the instant of the image, which blurs what moves (none: it is sharp). Without anybody who reads it nothing is rendered",
    ),
    (
        "sensor",
        "footage(field_of_view: Angle, at: Vector<base_link>, latency: Duration = 0 s, tilt: Angle = 0, k1: Number = 0, k2: Number = 0) -> Image",
        "Images of a recording, of whatever size, taken from `at` on the robot, looking ahead and `tilt` down; the lens is declared as that of a camera. In a trace place and lens are those of the camera that took them. A reading counts until the next one",
    ),
    (
        "sensor",
        "encoders(pulse: Length, period: Duration, latency: Duration = 0 s) -> Encoders",
        "Pulses counted at each wheel since the start",
    ),
    (
        "sensor",
        "odometry(pulse: Length, period: Duration, latency: Duration = 0 s) -> Odometry",
        "Pose in odom and twist, integrated from wheel pulses; starts at the origin",
    ),
    (
        "sensor",
        "gyro_odometry(pulse: Length, period: Duration, latency: Duration = 0 s, turn_noise: Distribution<AngularVelocity> = 0, turn_bias: Distribution<AngularVelocity> = 0) -> Odometry",
        "The same with the heading of a gyroscope, which sees what wheels that slip do not; the noise is drawn for every reading, the bias once a run",
    ),
    (
        "actuator",
        "twist(lifetime: Duration? = none) -> Twist",
        "Velocity of the body. A command lives for two periods of its unit unless a lifetime is given",
    ),
    (
        "actuator",
        "strides(duration: Duration) -> Stride",
        "A straight stride of a given heading and length, walked at constant speed within the duration",
    ),
    (
        "actuator",
        "gripper(reach: Length = 5 cm, lifetime: Duration? = none) -> Grip",
        "Closes around the nearest free parcel within reach of the rim of the body, and holds it until it is opened; what it held then lies in front of the robot",
    ),
    (
        "sensor",
        "holding(period: Duration, latency: Duration = 0 s) -> Grasp",
        "The number of the parcel that the gripper holds",
    ),
    (
        "sensor",
        "charge(period: Duration, latency: Duration = 0 s) -> Battery",
        "How full the battery of the platform is",
    ),
    (
        "power",
        "battery(energy: Energy, drive: Force, standby: Power = 0 W)",
        "What a full battery holds, what a metre of way takes and what a second takes; an empty one moves no robot. Without `power` a robot never tires",
    ),
    ("safe", "stop()", "Stand still; always possible"),
    ("safe", "hover()", "Stay where it is, in the air or in the water"),
    ("safe", "land()", "Come down where it is"),
    ("prepare", "stand()", "Nothing to prepare"),
    (
        "prepare",
        "take_off(height: Length)",
        "Climb to a height over the start; commands count from then on. What leaves the ground needs it",
    ),
    ("finish", "stop()", "Stand still"),
    ("finish", "land()", "Come down where it is"),
    ("bounds", "rectangle(low: Point<map>, high: Point<map>)", "The ground that pictures show; no wall"),
    (
        "floor",
        "plane(material: Text = \"concrete\")",
        "The ground that cameras see, under the bounds and 20 m around them",
    ),
    (
        "light",
        "lamp(ambient: Number = 0.45, strength: Number = 0.55, azimuth: Heading<map> = 1, elevation: Angle = 0.9, gain: Number = 1)",
        "What cameras see by: the share of its colour that every face shows, what a face turned at the lamp shows in addition, where the lamp stands, and a factor for all of it",
    ),
    (
        "current",
        "steady(velocity: Vector<map, Velocity>)",
        "The water moves, everywhere and always with the same velocity, which is level. It carries what goes under water; what rolls, walks or flies does not notice it",
    ),
    (
        "wall",
        "segment(from: Point<map>, to: Point<map>, height: Length = 50 cm, thickness: Length = 1 cm, material: Text = \"plaster\", mapped: Bool = true)",
        "A straight wall, centred on the segment; `mapped`: it is on the map that missions may know",
    ),
    (
        "obstacle",
        "cylinder(at: Point<map>, radius: Length, height: Length = 50 cm, material: Text = \"plaster\", mapped: Bool = true)",
        "An upright cylinder; `mapped` as of a wall",
    ),
    (
        "obstacle",
        "box(at: Point<map>, size: Vector<base_link>, heading: Heading<map> = 0, material: Text = \"plaster\", mapped: Bool = true)",
        "A box; size is length, width, height; `mapped` as of a wall",
    ),
    ("region", "circle(at: Point<map>, radius: Length)", "A round region of the ground"),
    ("region", "rectangle(low: Point<map>, high: Point<map>)", "An axis-parallel region of the ground"),
    (
        "mover",
        "disc(radius: Length, height: Length = 50 cm, path: List<Point<map>, N>, speed: Velocity, phase: Number = 0, material: Text = \"plaster\")",
        "A cylinder that walks along a path and back, for ever; phase is where in that round trip it starts, 0 .. 1",
    ),
    (
        "mover",
        "walker(path: List<Point<map>, N>, speed: Velocity, phase: Number = 0, radius: Length = 30 cm, height: Length = 1.75 m, skin: Text = \"#cd9b7d\", hair: Text = \"#3c2a1e\", shirt: Text = \"#b22c28\", trousers: Text = \"#2c3862\", shoes: Text = \"#24201e\")",
        "A person who walks along a path and from its end to its beginning, round and round; phase is where in that round it starts, 0 .. 1; at speed 0 it stands there, facing on. It is as wide as a cylinder of that radius; cameras see a figure whose arms and legs swing with the way it has gone, in clothes of these colours, as #rrggbb",
    ),
    (
        "mover",
        "wanderer(radius: Length, height: Length = 50 cm, at: Point<map>, heading: Heading<map>, speed: Velocity, turn_period: Duration, keep_out: Length? = none, material: Text = \"plaster\")",
        "A cylinder that walks straight, draws a new heading at every turn period, and is reflected by the bounds; given `keep_out`, its rim begins and stays that far from every robot's start and target",
    ),
    (
        "parcel",
        "crate(at: Point<map>, radius: Length = 10 cm)",
        "A thing to be carried: it lies on the ground, in nobody's way, until a gripper closes around it. Parcels are numbered in order, from 0",
    ),
    (
        "material",
        "plain(color: Text, reflectance: Number = 0.8)",
        "A colour, as #rrggbb, and how much infrared it reflects",
    ),
    (
        "material",
        "textured(texture: Text, repeat: Length = 1 m, reflectance: Number = 0.8)",
        "A pattern: `plaster`, `bricks`, `planks`, `tiles`, `checker`, `speckle`, `concrete` or `carpet`, that comes again after `repeat`, and how much infrared it reflects",
    ),
    (
        "material",
        "image(file: Text, width: Length = 1 m, reflectance: Number = 0.8)",
        "An image file, PNG or JPEG of at most 4096 pixels a side, as wide as `width` and as high as its proportions say, which comes again beside and above itself; and how much infrared it reflects",
    ),
    (
        "topic",
        "channel(delay: Duration = 1 us, loss: Number = 0, range: Length? = none, lifetime: Duration? = none, capacity: Int = 16)",
        "How messages travel: delay, chance of loss for each receiver, radio range (everywhere when none), how long the latest message counts (two periods of the publisher when none), how many senders are heard or messages wait",
    ),
    (
        "conversation",
        "channel(delay: Duration = 1 us, loss: Number = 0, capacity: Int = 64)",
        "How messages travel: delay, chance of loss, how many wait for a unit",
    ),
    (
        "fault",
        "kill(agent: Text, at: Duration)",
        "An agent dies: `NAME@ROBOT`, or `NAME` for one of that name that is drawn",
    ),
    (
        "fault",
        "drop(of: Text, chance: Number = 1, from: Duration = 0 s, until: Duration? = none)",
        "Messages of a topic or conversation are lost",
    ),
    (
        "fault",
        "delay(of: Text, by: Duration, chance: Number = 1, from: Duration = 0 s, until: Duration? = none)",
        "Messages of a topic or conversation take longer",
    ),
    (
        "fault",
        "duplicate(of: Text, chance: Number = 1, from: Duration = 0 s, until: Duration? = none)",
        "Messages of a topic or conversation arrive twice",
    ),
    (
        "fault",
        "corrupt(of: Text, chance: Number = 1, from: Duration = 0 s, until: Duration? = none)",
        "Messages of a topic or conversation arrive unreadable",
    ),
    (
        "fault",
        "dropout(sensor: Text, chance: Number = 1, from: Duration = 0 s, until: Duration? = none)",
        "Readings of a sensor, `ROBOT.SENSOR`, do not arrive",
    ),
    (
        "fault",
        "bias(sensor: Text, by: Length, from: Duration = 0 s, until: Duration? = none)",
        "Ranges and positions in the readings of a sensor, `ROBOT.SENSOR`, are off by so much",
    ),
    (
        "fault",
        "post(goal: Text, at: Duration)",
        "Somebody outside asks the planner-matcher for a goal, whether there is one of that name or not",
    ),
];

/// Every model.
pub static MODELS: LazyLock<Vec<Model>> = LazyLock::new(|| {
    TABLE
        .iter()
        .map(|(role, text, doc)| Model {
            role,
            signature: Signature::parse(text).unwrap_or_else(|e| panic!("model `{text}`: {e}")),
            doc,
        })
        .collect()
});

/// The model `name` of a role.
pub fn model(role: &str, name: &str) -> Option<&'static Model> {
    MODELS.iter().find(|m| m.role == role && &*m.signature.name == name)
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_model_parses() {
        assert!(super::model("sensor", "infrared").is_some());
    }
}
