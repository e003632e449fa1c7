//! Takes images: at once, or on a thread of its own while the run goes on.

use super::{Mounted, Studio};
use soifra_camera::{Exposure, Filter, Image, Light, Scratch, View, noise, render_blurred};
use soifra_runtime::{
    Time,
    objects::{Frame, digest},
};
use std::{
    fmt,
    sync::{
        Arc,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
};

/// Orders that may wait for the thread; a run that gets farther ahead waits for it.
const WAITING: usize = 64;

/// An image that is to be taken.
#[derive(Debug, Clone)]
pub struct Order {
    /// Robot, by index.
    pub robot: u32,
    /// Sensor of its platform, by index.
    pub sensor: u32,
    /// When it is taken.
    pub captured: Time,
    /// From where, and what is to be seen; see [`Studio::view`].
    pub view: Vec<f64>,
}

impl Studio {
    /// Takes an image; none for a view that is none of this scene.
    pub fn take(&self, order: &Order, desk: &mut Desk) -> Option<Frame> {
        let camera: &Mounted = self.camera(order.robot, order.sensor)?;
        let poses = if camera.exposure > 0.0 { order.view.len() / 2 } else { order.view.len() };
        let (opening, closing) = order.view.split_at(poses);
        let (body, parts) = self.placed(order.robot, opening)?;
        let (end, parts_at_end) = match closing {
            [] => (body, Vec::new()),
            closing => self.placed(order.robot, closing)?,
        };
        let light = Light { gain: self.light.gain * camera.gain, ..self.light };
        let pose = body.after(&camera.mount);
        let view = View { lens: &camera.lens, pose, light: &light, filter: Filter::Mipmap };
        let mut image = Image::new(0, 0);
        let exposure = Exposure {
            pose: end.after(&camera.mount),
            parts: &parts_at_end,
            instants: instants(self.poses(opening), self.poses(closing), camera.lens.fx),
        };
        render_blurred(&self.scene, &parts, &view, &exposure, 1, &mut image, &mut desk.scratch);
        noise(&mut image, camera.noise, self.key(order.robot, camera), order.captured.0 as u64);
        let (width, height) = (image.width as u32, image.height as u32);
        Some(Frame {
            digest: digest(width, height, &image.data),
            width,
            height,
            data: image.data,
            optics: camera.optics(),
            captured: order.captured,
            view: order.view.clone(),
        })
    }
}

/// Instants of an exposure that are averaged, at most.
const MOST_INSTANTS: usize = 16;

/// Things are taken to be no nearer, m, when it is told how far they move over the image.
const NEAREST: f64 = 1.0;

/// How many instants are averaged between the poses at the opening and the closing of a shutter: one for every pixel that
/// something may move in between, and one to begin with. `focal` is in pixels.
fn instants(opening: &[f64], closing: &[f64], focal: f64) -> usize {
    let norm = |a: &[f64], b: &[f64], sign: f64| {
        a.iter().zip(b).map(|(a, b)| (a - sign * b) * (a - sign * b)).sum::<f64>().sqrt()
    };
    let (from, to) = (opening.as_chunks::<7>().0, closing.as_chunks::<7>().0);
    let moved = from.iter().zip(to).map(|(a, b)| norm(&a[..3], &b[..3], 1.0));
    // Half of the angle between two quaternions that agree is about their distance.
    let turned = from.iter().zip(to).next();
    let turned = turned.map_or(0.0, |(a, b)| norm(&a[3..], &b[3..], 1.0).min(norm(&a[3..], &b[3..], -1.0)));
    let pixels = focal * (2.0 * turned + moved.fold(0.0, f64::max) / NEAREST);
    1 + (pixels.ceil() as usize).min(MOST_INSTANTS - 1)
}

/// What is kept from image to image.
#[derive(Default)]
pub struct Desk {
    scratch: Scratch,
}

/// What the thread is to take, and where to.
type Job = (Order, SyncSender<Option<Frame>>);

/// Takes the images of a run.
pub struct Cameraman {
    studio: Arc<Studio>,
    desk: Desk,
    thread: Option<(SyncSender<Job>, JoinHandle<()>)>,
}

/// An image that has been ordered.
#[derive(Debug)]
pub enum Taking {
    /// It is taken when it is wanted.
    Later(Order),
    /// The thread takes it.
    Elsewhere(Receiver<Option<Frame>>, Order),
}

impl fmt::Debug for Cameraman {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cameraman").field("thread", &self.thread.is_some()).finish_non_exhaustive()
    }
}

impl Cameraman {
    /// With a thread of its own where there may be more than one. The images are the same.
    pub fn new(studio: Studio, threads: usize) -> Cameraman {
        let studio = Arc::new(studio);
        let thread = (threads > 1).then(|| {
            let (orders, receiver) = sync_channel::<Job>(WAITING);
            let studio = Arc::clone(&studio);
            let work = move || {
                let mut desk = Desk::default();
                while let Ok((order, answer)) = receiver.recv() {
                    // Nobody waits any more when the run is over.
                    let _ = answer.send(studio.take(&order, &mut desk));
                }
            };
            thread::Builder::new().name("camera".into()).spawn(work).ok().map(|t| (orders, t))
        });
        Cameraman { studio, desk: Desk::default(), thread: thread.flatten() }
    }

    /// What can be seen.
    pub fn studio(&self) -> &Studio {
        &self.studio
    }

    /// Orders an image.
    pub fn order(&self, order: Order) -> Taking {
        if let Some((orders, _)) = &self.thread {
            let (answer, receiver) = sync_channel(1);
            if orders.send((order.clone(), answer)).is_ok() {
                return Taking::Elsewhere(receiver, order);
            }
        }
        Taking::Later(order)
    }

    /// Hands over an image.
    pub fn deliver(&mut self, taking: Taking) -> Option<Frame> {
        match taking {
            Taking::Later(order) => self.studio.take(&order, &mut self.desk),
            Taking::Elsewhere(receiver, order) => match receiver.recv() {
                Ok(image) => image,
                // The thread is gone; the image is the same.
                Err(_) => self.studio.take(&order, &mut self.desk),
            },
        }
    }
}

impl Drop for Cameraman {
    fn drop(&mut self) {
        if let Some((orders, thread)) = self.thread.take() {
            drop(orders);
            // It ends when it has taken what is still ordered.
            let _ = thread.join();
        }
    }
}
