//! Topics as boards: the last few messages of every sender, from which receivers read what they hear.
//!
//! A message is on the air from `delay` after it was sent until its lifetime is over. A receiver hears
//! the newest message of a sender that is on the air and was not lost on the way to it; whether it was
//! lost is a function of seed, topic, sender, receiver and message number. With a radio range, the
//! receiver must be within range of the place where the message was sent from. When more senders than the
//! capacity are heard, the nearest count, nearest first; else they come in the order of the senders.
//!
//! Places are world truth, which a radio obeys without knowing it. Where there is no world truth, every
//! message is in range, and the first senders count.

use super::grid::{Grid, Site, Visitor};
use crate::{Time, seed::chance};
use serde::{Deserialize, Serialize};
use soifra_graph::eval::copy_registers;
use std::sync::Arc;

/// How the messages of a topic travel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Channel {
    pub width: usize,
    pub delay: Time,
    pub loss: f64,
    pub range: Option<f64>,
    /// Lifetime of all its messages; that of the unit that publishes when absent.
    pub lifetime: Option<Time>,
    pub capacity: usize,
}

/// The most messages of a sender that a board keeps.
const MOST_KEPT: usize = 32;

/// A message of a sender.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Stamp {
    from: Time,
    until: Time,
    record: u64,
    place: [f64; 3],
}

/// What a board keeps.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Kept {
    /// Messages sent so far, a sender.
    sent: Vec<u64>,
    /// A ring of messages for each sender.
    stamps: Vec<Stamp>,
    registers: Vec<f64>,
}

/// A topic.
#[derive(Debug)]
pub(crate) struct Board {
    pub channel: Channel,
    topic: u32,
    seed: u64,
    /// Instances that publish.
    senders: Arc<[u32]>,
    /// Number of each instance among the senders.
    number: Vec<Option<u32>>,
    /// Messages kept a sender.
    ring: usize,
    kept: Kept,
    /// Places of the newest messages on the air.
    grid: Grid,
    sites: Vec<Site>,
    /// The instant for which the grid holds.
    built: Option<Time>,
    /// Whether places matter and are known.
    placed: bool,
}

/// A message that is heard.
#[derive(Debug, Clone, Copy, Default)]
struct Heard {
    /// Distance of the sender, squared.
    far: f64,
    sender: u32,
    slot: u32,
}

/// Room for one question, kept between questions.
#[derive(Debug, Default)]
pub(crate) struct Near(Vec<Heard>);

/// More messages than this are sorted; fewer are put in order by counting.
const FEW: usize = 12;

impl Board {
    /// Of all messages that are kept.
    pub fn registers(&self) -> &[f64] {
        &self.kept.registers
    }

    /// A board for senders whose shortest period is `period`.
    pub fn new(
        seed: u64,
        topic: u32,
        channel: Channel,
        senders: Vec<u32>,
        period: Option<Time>,
        truth: bool,
    ) -> Self {
        let per = |t: Time| period.map_or(4, |p| (t.0 / p.0.max(1)).clamp(0, MOST_KEPT as i64) as usize + 1);
        let spare = match channel.lifetime {
            _ if channel.loss <= 0.0 => 0,
            Some(l) => per(l),
            None => 2,
        };
        let ring = (per(channel.delay) + 1 + spare).min(MOST_KEPT);
        let crowded = channel.range.is_some() || senders.len() > channel.capacity;
        let stamp = Stamp { from: Time::MAX, until: Time::ZERO, record: 0, place: [0.0; 3] };
        let kept = Kept {
            sent: vec![0; senders.len()],
            stamps: vec![stamp; senders.len() * ring],
            registers: vec![0.0; senders.len() * ring * channel.width],
        };
        let mut number = vec![None; senders.last().map_or(0, |s| *s as usize + 1)];
        for (s, instance) in senders.iter().enumerate() {
            number[*instance as usize] = Some(s as u32);
        }
        Board {
            channel,
            topic,
            seed,
            senders: senders.into(),
            number,
            ring,
            kept,
            grid: Grid::default(),
            sites: Vec::new(),
            built: None,
            placed: truth && crowded,
        }
    }

    /// What it keeps now.
    pub fn kept(&self) -> Kept {
        self.kept.clone()
    }

    /// Takes up what the same board kept; false when it did not.
    pub fn resume(&mut self, kept: Kept) -> bool {
        let shape = |k: &Kept| (k.sent.len(), k.stamps.len(), k.registers.len());
        let fits = shape(&kept) == shape(&self.kept);
        if fits {
            (self.kept, self.built) = (kept, None);
        }
        fits
    }

    /// Whether it asks where robots are.
    pub fn placed(&self) -> bool {
        self.placed
    }

    /// Publishes, and returns the number of the message among those of its sender. `lifetime` is that of
    /// the unit.
    pub fn publish(
        &mut self,
        now: Time,
        instance: u32,
        registers: &[f64],
        lifetime: Time,
        record: u64,
        place: [f64; 3],
    ) -> u64 {
        let Some(Some(s)) = self.number.get(instance as usize) else { return 0 };
        let s = *s as usize;
        let number = self.kept.sent[s];
        let slot = s * self.ring + (number % self.ring as u64) as usize;
        let from = now + self.channel.delay;
        let until = from + self.channel.lifetime.unwrap_or(lifetime);
        self.kept.stamps[slot] = Stamp { from, until, record, place };
        let at = slot * self.channel.width;
        let width = self.channel.width.min(registers.len());
        copy_registers(&registers[..width], &mut self.kept.registers[at..at + width]);
        self.kept.sent[s] = number + 1;
        number
    }

    /// Whether message `number` of a sender is lost on its way to a receiver.
    pub fn lost(&self, sender: u32, receiver: u32, number: u64) -> bool {
        let (t, s, r) = (u64::from(self.topic), u64::from(sender), u64::from(receiver));
        self.channel.loss > 0.0 && chance(self.seed, t, s, r, number) < self.channel.loss
    }

    /// Sorts the messages that are on the air at `now` by place, once an instant.
    pub fn prepare(&mut self, now: Time) {
        if !self.placed || self.built == Some(now) {
            return;
        }
        self.built = Some(now);
        self.sites.clear();
        for s in 0..self.senders.len() {
            if let Some(slot) = self.newest(s, now, |_| true) {
                let at = self.kept.stamps[slot].place;
                self.sites.push(Site { at, sender: self.senders[s], message: slot as u32 });
            }
        }
        self.grid.build(&self.sites, self.channel.range.unwrap_or(f64::INFINITY));
    }

    /// The ring slot of the newest message of sender `s` that is on the air and is `wanted` by number.
    fn newest(&self, s: usize, now: Time, wanted: impl Fn(u64) -> bool) -> Option<usize> {
        let sent = self.kept.sent[s];
        for back in 1..=sent.min(self.ring as u64) {
            let number = sent - back;
            let slot = s * self.ring + (number % self.ring as u64) as usize;
            let stamp = &self.kept.stamps[slot];
            if stamp.from > now {
                continue;
            }
            if stamp.until < now {
                return None;
            }
            if wanted(number) {
                return Some(slot);
            }
        }
        None
    }

    /// Puts what `receiver` hears at `place` into `out`: count, then items. Record numbers of the messages
    /// go to `records`, if wanted.
    pub fn hear(
        &self,
        now: Time,
        receiver: u32,
        place: [f64; 3],
        out: &mut [f64],
        near: &mut Near,
        mut records: Option<&mut Vec<u64>>,
    ) {
        let width = self.channel.width.max(1);
        let capacity = (out.len().saturating_sub(1) / width).min(self.channel.capacity);
        let (mut found, by_distance) = if self.placed {
            let range = self.channel.range.unwrap_or(f64::INFINITY);
            let mut listener = Listener {
                board: self,
                now,
                receiver,
                place,
                square: range * range,
                capacity,
                near,
                found: 0,
            };
            self.grid.around(place, range, &mut listener);
            let found = listener.found;
            (found, found > capacity)
        } else {
            (self.hear_first(now, receiver, capacity, near), false)
        };
        if by_distance {
            let order = |a: &Heard, b: &Heard| a.far.total_cmp(&b.far).then(a.sender.cmp(&b.sender));
            let all = &mut near.0[..found];
            if capacity > 0 {
                all.select_nth_unstable_by(capacity - 1, order);
            }
            found = capacity;
            all[..found].sort_unstable_by(order);
        } else if found > FEW || records.is_some() {
            near.0[..found].sort_unstable_by_key(|f| f.sender);
        }
        let sorted = by_distance || found > FEW || records.is_some();
        let found = &near.0[..found];
        let Some((count, items)) = out.split_first_mut() else { return };
        *count = found.len() as f64;
        let (items, rest) = items.split_at_mut(found.len() * width);
        rest.fill(0.0);
        for (i, f) in found.iter().enumerate() {
            let i = if sorted {
                i
            } else {
                found.iter().map(|g| usize::from(g.sender < f.sender)).sum::<usize>()
            };
            let at = f.slot as usize * self.channel.width;
            let message = &self.kept.registers[at..at + self.channel.width];
            copy_registers(message, &mut items[i * width..i * width + self.channel.width]);
            if let Some(records) = records.as_deref_mut() {
                records.push(self.kept.stamps[f.slot as usize].record);
            }
        }
    }

    /// The first messages that are heard, when places do not matter; returns how many.
    fn hear_first(&self, now: Time, receiver: u32, capacity: usize, near: &mut Near) -> usize {
        near.0.clear();
        for (s, &sender) in self.senders.iter().enumerate() {
            if near.0.len() == capacity {
                break;
            }
            if sender != receiver
                && let Some(slot) = self.received(s, receiver, now)
            {
                near.0.push(Heard { far: 0.0, sender, slot: slot as u32 });
            }
        }
        near.0.len()
    }

    fn received(&self, s: usize, receiver: u32, now: Time) -> Option<usize> {
        let sender = self.senders[s];
        self.newest(s, now, |number| !self.lost(sender, receiver, number))
    }
}

/// A receiver among the places of messages.
struct Listener<'a> {
    board: &'a Board,
    now: Time,
    receiver: u32,
    place: [f64; 3],
    /// The range, squared.
    square: f64,
    capacity: usize,
    near: &'a mut Near,
    /// How many of `near` are heard.
    found: usize,
}

impl Listener<'_> {
    /// Squared distance of a place.
    #[inline]
    fn far(&self, at: [f64; 3]) -> f64 {
        let d = [at[0] - self.place[0], at[1] - self.place[1], at[2] - self.place[2]];
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    }

    /// As [`Visitor::look`] where messages can be lost.
    fn look_for_received(&mut self, sites: &[Site]) {
        for site in sites {
            if self.far(site.at) > self.square || site.sender == self.receiver {
                continue;
            }
            let sender = site.message as usize / self.board.ring;
            let Some(slot) = self.board.received(sender, self.receiver, self.now) else { continue };
            let far = self.far(self.board.kept.stamps[slot].place);
            if far <= self.square {
                self.near.0[self.found] = Heard { far, sender: site.sender, slot: slot as u32 };
                self.found += 1;
            }
        }
    }
}

impl Visitor for Listener<'_> {
    #[inline(always)]
    fn look(&mut self, sites: &[Site]) {
        let most = self.found + sites.len();
        if self.near.0.len() < most {
            self.near.0.resize(most, Heard::default());
        }
        if self.board.channel.loss > 0.0 {
            return self.look_for_received(sites);
        }
        // Each is put down, and counted when it is heard: nothing that would have to be guessed.
        let mut found = self.found;
        for site in sites {
            let far = self.far(site.at);
            self.near.0[found] = Heard { far, sender: site.sender, slot: site.message };
            found += usize::from(far <= self.square && site.sender != self.receiver);
        }
        self.found = found;
    }

    fn enough(&self, seen: f64) -> bool {
        let found = &self.near.0[..self.found];
        found.len() > self.capacity && found.iter().filter(|f| f.far <= seen * seen).count() > self.capacity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn board(channel: Channel, senders: u32, truth: bool) -> Board {
        Board::new(1, 0, channel, (0..senders).collect(), Some(Time(100)), truth)
    }

    fn plain() -> Channel {
        Channel { width: 1, delay: Time(10), loss: 0.0, range: None, lifetime: None, capacity: 4 }
    }

    fn heard(b: &mut Board, now: i64, receiver: u32, place: [f64; 3]) -> Vec<f64> {
        b.prepare(Time(now));
        let mut out = vec![9.0; 5];
        b.hear(Time(now), receiver, place, &mut out, &mut Near::default(), None);
        let n = out[0] as usize;
        out[1..1 + n].to_vec()
    }

    #[test]
    fn a_message_is_heard_after_its_delay_until_its_lifetime_is_over() {
        let mut b = board(plain(), 3, false);
        b.publish(Time(0), 1, &[5.0], Time(200), 0, [0.0; 3]);
        assert_eq!(heard(&mut b, 9, 0, [0.0; 3]), []);
        assert_eq!(heard(&mut b, 10, 0, [0.0; 3]), [5.0]);
        assert_eq!(heard(&mut b, 10, 1, [0.0; 3]), [], "nobody hears himself");
        b.publish(Time(100), 1, &[6.0], Time(200), 0, [0.0; 3]);
        assert_eq!(heard(&mut b, 105, 0, [0.0; 3]), [5.0], "the newer one is on its way");
        assert_eq!(heard(&mut b, 310, 0, [0.0; 3]), [6.0]);
        assert_eq!(heard(&mut b, 311, 0, [0.0; 3]), []);
    }

    #[test]
    fn range_and_capacity_choose_the_nearest() {
        let mut b = board(Channel { range: Some(5.0), capacity: 2, ..plain() }, 5, true);
        for i in 0..5u32 {
            b.publish(Time(0), i, &[f64::from(i)], Time(500), 0, [f64::from(4 - i), 0.0, 0.0]);
        }
        assert_eq!(heard(&mut b, 10, 9, [0.0; 3]), [4.0, 3.0]);
        assert_eq!(heard(&mut b, 20, 9, [8.0, 0.0, 0.0]), [0.0, 1.0]);
        assert_eq!(heard(&mut b, 30, 9, [8.5, 0.0, 0.0]), [0.0]);
        assert_eq!(heard(&mut b, 40, 9, [9.5, 0.0, 0.0]), []);
    }

    #[test]
    fn a_lost_message_leaves_the_one_before() {
        let mut b = board(Channel { loss: 0.5, ..plain() }, 2, false);
        let (mut new, mut old, mut none) = (0, 0, 0);
        for k in 0..400 {
            b.publish(Time(100 * k), 1, &[k as f64], Time(200), 0, [0.0; 3]);
            match heard(&mut b, 100 * k + 50, 0, [0.0; 3])[..] {
                [x] if x == k as f64 => new += 1,
                [x] if x < k as f64 => old += 1,
                [] => none += 1,
                _ => panic!(),
            }
        }
        assert!(
            (170..230).contains(&new) && (75..125).contains(&old) && (75..125).contains(&none),
            "{new} {old} {none}"
        );
    }
}
