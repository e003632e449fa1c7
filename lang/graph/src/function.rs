//! The built-in functions: names, signatures, one line of documentation each. What they compute is
//! in `eval/`; `docs/language.md` lists them from here.

use crate::signature::Signature;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, sync::LazyLock};

macro_rules! functions {
    ($($variant:ident $signature:literal $doc:literal;)*) => {
        /// A built-in function.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Function { $(#[doc = $doc] $variant,)* }

        /// Every built-in function with its signature text and documentation.
        pub const FUNCTIONS: &[(Function, &str, &str)] = &[$((Function::$variant, $signature, $doc),)*];
    };
}

functions! {
    Abs "abs<D>(x: Quantity<D>) -> Quantity<D>" "Absolute value";
    Min "min<D>(a: Quantity<D>, b: Quantity<D>) -> Quantity<D>" "The smaller of two";
    Max "max<D>(a: Quantity<D>, b: Quantity<D>) -> Quantity<D>" "The larger of two";
    Clamp "clamp<D>(x: Quantity<D>, low: Quantity<D>, high: Quantity<D>) -> Quantity<D>" "`x` held between `low` and `high`";
    Sign "sign<D>(x: Quantity<D>) -> Number" "-1, 0 or 1";
    Floor "floor(x: Number) -> Int" "The whole number at or below";
    Ceil "ceil(x: Number) -> Int" "The whole number at or above";
    Round "round(x: Number) -> Int" "The nearest whole number, halves away from zero";
    Modulo "modulo<D>(x: Quantity<D>, y: Quantity<D>) -> Quantity<D>" "What remains of `x` divided by `y`, never negative";
    Sin "sin(angle: Angle) -> Number" "Sine";
    Cos "cos(angle: Angle) -> Number" "Cosine";
    Tan "tan(angle: Angle) -> Number" "Tangent";
    Asin "asin(x: Number) -> Angle" "Arc sine; `x` within -1 .. 1";
    Acos "acos(x: Number) -> Angle" "Arc cosine; `x` within -1 .. 1";
    Atan2 "atan2<D>(y: Quantity<D>, x: Quantity<D>) -> Angle" "The angle of the point (x, y)";
    Exp "exp(x: Number) -> Number" "e to the power `x`";
    Log "log(x: Number) -> Number" "Natural logarithm; `x` above 0";
    Hypot "hypot<D>(a: Quantity<D>, b: Quantity<D>) -> Quantity<D>" "Length of the hypotenuse";
    Wrap "wrap(angle: Angle) -> Angle" "The same direction within -180 deg .. 180 deg";
    Towards "towards(angle: Angle) -> Heading<map>" "The map heading at `angle` counter-clockwise from east";
    AngleOf "angle_of<F>(heading: Heading<F>) -> Angle" "The angle of a heading, counter-clockwise from x, within -180 deg .. 180 deg";
    HeadingOf "heading_of<F, D>(v: Vector<F, D>) -> Heading<F>" "The direction of a vector in the xy-plane; that of a zero vector is x";
    Polar "polar<F, D>(length: Quantity<D>, heading: Heading<F>) -> Vector<F, D>" "The vector of a length and a heading";
    Norm "norm<F, D>(v: Vector<F, D>) -> Quantity<D>" "Length of a vector";
    Unit "unit<F, D>(v: Vector<F, D>) -> Vector<F, Number>" "Vector of length one; a zero vector stays zero";
    Distance "distance<F>(a: Point<F>, b: Point<F>) -> Length" "Distance between two points";
    Rotate "rotate<F, D>(v: Vector<F, D>, by: Angle) -> Vector<F, D>" "`v` turned about z, counter-clockwise";
    PoseAt "pose<F>(at: Point<F>, heading: Heading<F>) -> Pose<F>" "The level pose at a point, facing a heading";
    Bearing "bearing<F>(of: Point<F>, from: Pose<F>) -> Angle" "Where a point is seen from a pose, counter-clockwise from straight ahead";
    Place "place<F, G>(pose: Pose<F>, origin: Pose<G>) -> Pose<G>" "`pose`, when the origin of its frame is at `origin`";
    FromBody "from_body<F, D>(v: Vector<base_link, D>, pose: Pose<F>) -> Vector<F, D>" "A body vector in the frame of the body's pose";
    ToBody "to_body<F, D>(v: Vector<F, D>, pose: Pose<F>) -> Vector<base_link, D>" "A vector as the body at `pose` sees it";
    PointFromBody "point_from_body<F>(p: Point<base_link>, pose: Pose<F>) -> Point<F>" "A body point in the frame of the body's pose";
    PointToBody "point_to_body<F>(p: Point<F>, pose: Pose<F>) -> Point<base_link>" "A point as the body at `pose` sees it";
    Twist "twist(forward: Velocity, turn: AngularVelocity = 0 rad/s, left: Velocity = 0 m/s, up: Velocity = 0 m/s) -> Twist" "A velocity of the body";
    CircleIntersections "circle_intersections<F>(a: Point<F>, a_radius: Length, b: Point<F>, b_radius: Length) -> List<Point<F>, 2>" "Where two circles cross in the xy-plane: none, one or two points";
    FirstContact "first_contact<F>(from: Point<F>, motion: Vector<F>, center: Point<F>, radius: Length) -> Number?" "The fraction (0 .. 1) of `motion` at which a point that starts at `from` first comes within `radius` of `center` in the xy-plane; none when it never does";
    Inside "inside(p: Point<map>, region: handle Region) -> Bool" "Whether a point is in a region of the world";
    Length "length<T>(list: List<T, N>) -> Int" "Number of items";
    At "at<T>(list: List<T, N>, index: Int) -> T?" "The item at `index`, counted from 0";
    First "first<T>(list: List<T, N>) -> T?" "The first item";
    Last "last<T>(list: List<T, N>) -> T?" "The last item";
    Push "push<T>(list: List<T, N>, item: T) -> List<T, N>" "The list with `item` at its end; a full list loses its first item";
    Sum "sum<D>(list: List<Quantity<D>, N>) -> Quantity<D>" "Sum of the items";
    Smallest "smallest<D>(list: List<Quantity<D>, N>) -> Quantity<D>?" "The smallest item";
    Largest "largest<D>(list: List<Quantity<D>, N>) -> Quantity<D>?" "The largest item";
    Exactly "exactly<D>(value: Quantity<D>) -> Distribution<D>" "The distribution that always gives `value`";
    Normal "normal<D>(sd: Quantity<D>, mean: Quantity<D> = 0) -> Distribution<D>" "Gaussian";
    Uniform "uniform<D>(low: Quantity<D>, high: Quantity<D>) -> Distribution<D>" "Uniform between two bounds";
    Skewed "skewed<D>(best: Quantity<D>, mean: Quantity<D>, worst: Quantity<D>) -> Distribution<D>" "Bounded, with the bulk near `best` and a tail to `worst`";
    Draw "draw<D>(from: Distribution<D>) -> Quantity<D>" "A value drawn from a distribution, from the run's seed";
    Low "low<D>(range: Range<D>) -> Quantity<D>" "Lower bound";
    High "high<D>(range: Range<D>) -> Quantity<D>" "Upper bound";
    Brightness "brightness(image: Image) -> Number" "How bright an image is in the mean, 0 to 1";
    Look "look(image: Image, before: Sight?, imu: Imu? = none, odometry: Odometry? = none, half_width: Length = 0, margin: Length = 0, low: Number? = none, high: Number? = none, window: Duration = 2.5 s) -> Sight?" "What is seen in an image: upright edges, followed since `before`, paired to obstacles, and points on the first of them: the nearest that a body of that half width with a margin would meet, else the nearest. Without `imu` the camera is level, without `odometry` it goes straight ahead at a constant speed that nobody knows. `low` and `high` are Canny's thresholds, found from the image where they are left out; `window` is how far back edges are remembered";
    Viewpoint "viewpoint(sight: Sight) -> Viewpoint" "From where an image was taken";
    Obstacles "obstacles(sight: Sight) -> List<SeenObstacle, 8>" "The obstacles that are seen, those in the way first, each nearest first";
    ContactByExpansion "contact_by_expansion(sight: Sight) -> Duration?" "Time to contact of the camera with the first obstacle by the growth of its width (SOIFRA, Eq. 13), over a window of images";
    ContactByFlow "contact_by_flow(sight: Sight) -> Duration?" "Time to contact of the camera with the first obstacle by the flow between two images and its focus of expansion (SOIFRA, Eq. 4)";
    ContactByRobustFlow "contact_by_robust_flow(sight: Sight, rotating: AngularVelocity = 0.6 rad/s) -> Duration?" "The same by flow over a longer time, with the robot's own turns taken out; none while it turns faster than `rotating`";
    Diverging "diverging(sight: Sight) -> Bool?" "Whether the flows of the first obstacle's sides do not meet (the published test of a collision course)";
    CourseAhead "course_ahead(sight: Sight, radius: Length = 0, least: Angle = 0) -> CourseAhead?" "What going straight on leads to, for the body and margin that `look` was told, and how far to turn, on a curve of that radius and by that much at least, for a free way";
    NearestPairAhead "nearest_pair_ahead(sight: Sight) -> CourseAhead?" "The same by the published detection (SOIFRA, Algorithm 1): the nearest upright edge on each side of the optical centre, a collision when their flows between two images do not meet, the distance by the focus of expansion of that flow (Eq. 4), and more room on the side where the pair is not. Of clearance and turns it says nothing: they are 0";
    WatchPeople "watch_people(image: Image, before: People?, odometry: Odometry, imu: Imu? = none) -> People?" "Who is seen in an image: people are found by their shape (histograms of oriented gradients, Dalal and Triggs 2005), where they are whole in the image, and followed since `before` by the colours of their clothes. They stand on level ground, and so does the robot; without `imu` the camera is level";
    PeopleSeen "people_seen(people: People) -> List<SeenPerson, 8>" "Those who are seen, or were a moment ago, in the order of their numbers";
    KnownMap "known_map(resolution: Length = 5 cm) -> OccupancyGrid?" "The walls and obstacles of the world that are on the map, over its bounds, as a grid with cells of that side; none without bounds";
    TrueMap "true_map(resolution: Length = 5 cm) -> OccupancyGrid?" "The same of all walls and obstacles that there are: truth, for `done`, `expect` and `metric` only";
    TruePlace "true_place(mover: Int) -> Point<map>?" "Where a mover of the world is, counted from 0 in the order in which they are declared: truth, for `done`, `expect` and `metric` only; none when there are not as many";
    EmptyMap "empty_map(low: Point<map>, high: Point<map>, resolution: Length = 5 cm) -> OccupancyGrid?" "A grid over a rectangle of which nothing is known";
    Observe "observe(grid: OccupancyGrid, at: Pose<map>, scan: List<Beam, N>, reach: Length = 30 m) -> OccupancyGrid" "The grid after a scan from that pose: what beams went through is more likely free, what they ended in more likely occupied (Probabilistic Robotics, Table 9.1)";
    Localise "localise(before: Particles?, start: Pose<map>, odometry: Pose<odom>, scan: List<Beam, N>, grid: OccupancyGrid, random: Number, count: Int = 400, spread: Length = 20 cm, turn_spread: Angle = 5 deg) -> Particles?" "Where the robot may be on a map: particles that are moved by odometry and weighed by a scan (Monte Carlo localisation, Probabilistic Robotics, Table 8.2); at first `count` of them, spread about `start`. `random` is a number drawn anew for each call";
    Located "located(particles: Particles) -> Located" "What particles come to: mean pose, where the frame of odometry begins, and how sure that is";
    MatchScan "match_scan(grid: OccupancyGrid, guess: Pose<map>, scan: List<Beam, N>, window: Length = 16 cm, turn_window: Angle = 4 deg) -> Pose<map>?" "The pose near a guess at which a scan fits a grid best (correlative scan matching, Olson 2009)";
    PlanPath "plan_path(grid: OccupancyGrid, from: Point<map>, to: Point<map>, clearance: Length, comfort: Length = 50 cm) -> Path?" "The cheapest way over a grid that keeps `clearance` from all that is occupied (A*), smoothed; where there is room it keeps `comfort` more. What is unknown counts as free";
    Track "track(path: Path, at: Pose<map>, lookahead: Length) -> Tracking" "How far a pose is off a path, and the arc back to the point of it that is `lookahead` beyond the nearest (pure pursuit, Coulter 1992)";
    FreeWay "free_way(path: Path, grid: OccupancyGrid, at: Point<map>, clearance: Length) -> Length" "How far a path is free from the point of it that is nearest to `at`: to where something occupied is nearer than `clearance`, or to its end";
    MapOverlap "map_overlap(a: OccupancyGrid, b: OccupancyGrid) -> Number" "Intersection over union of what is not free in two grids, over the ground of the first, 0 to 1: of cells that are occupied or of which nothing is known";
    Within "within<D>(x: Quantity<D>, range: Range<D>) -> Bool" "Whether a quantity is in a range";
}

impl Function {
    /// The function called `name`.
    pub fn named(name: &str) -> Option<Function> {
        BY_NAME.get(name).copied()
    }

    /// Its signature.
    pub fn signature(self) -> &'static Signature {
        &SIGNATURES[&self]
    }

    /// Whether it is computed by a service of the runtime's surroundings, such as a library for images, and not by
    /// the machine itself: whatever takes or gives an opaque value, since only services look into one, and what the
    /// judge of a run answers.
    pub fn is_service(self) -> bool {
        let s = self.signature();
        self == Function::TruePlace
            || s.result.is_opaque()
            || s.parameters.iter().any(|p| p.pattern.is_opaque())
    }

    /// Whether it tells the truth about the world, which no behaviour can know.
    pub fn is_truth(self) -> bool {
        matches!(self, Function::TrueMap | Function::TruePlace)
    }

    /// Whether two calls with the same arguments may give different values.
    pub fn is_random(self) -> bool {
        self == Function::Draw
    }
}

static SIGNATURES: LazyLock<BTreeMap<Function, Signature>> = LazyLock::new(|| {
    FUNCTIONS
        .iter()
        .map(|(f, text, _)| {
            (*f, Signature::parse(text).unwrap_or_else(|e| panic!("signature `{text}`: {e}")))
        })
        .collect()
});

static BY_NAME: LazyLock<BTreeMap<&'static str, Function>> = LazyLock::new(|| {
    FUNCTIONS.iter().map(|(f, text, _)| (&text[..text.find(['<', '(']).unwrap_or(text.len())], *f)).collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_signature_parses_and_names_itself() {
        for (f, _, _) in FUNCTIONS {
            assert_eq!(Function::named(&f.signature().name), Some(*f));
        }
    }
}
