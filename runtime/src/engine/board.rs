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

use super::grid::{Grid, Site};
use crate::{Time, seed::chance};
use serde::{Deserialize, Serialize};
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
struct Kept {
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

/// Room for one question, kept between questions.
#[derive(Debug, Default)]
pub(crate) struct Near(Vec<(f64, u32, u32)>);

impl Board {
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
        Board {
            channel,
            topic,
            seed,
            senders: senders.into(),
            ring,
            kept,
            grid: Grid::default(),
            sites: Vec::new(),
            built: None,
            placed: truth && crowded,
        }
    }

    /// Whether it asks where robots are.
    pub fn placed(&self) -> bool {
        self.placed
    }

    /// Publishes. `lifetime` is that of the unit.
    pub fn publish(
        &mut self,
        now: Time,
        instance: u32,
        registers: &[f64],
        lifetime: Time,
        record: u64,
        place: [f64; 3],
    ) {
        let Ok(s) = self.senders.binary_search(&instance) else { return };
        let slot = s * self.ring + (self.kept.sent[s] % self.ring as u64) as usize;
        let from = now + self.channel.delay;
        let until = from + self.channel.lifetime.unwrap_or(lifetime);
        self.kept.stamps[slot] = Stamp { from, until, record, place };
        let at = slot * self.channel.width;
        let width = self.channel.width.min(registers.len());
        self.kept.registers[at..at + width].copy_from_slice(&registers[..width]);
        self.kept.sent[s] += 1;
    }

    /// Number of the message that `instance` will publish next.
    pub fn number(&self, instance: u32) -> u64 {
        self.senders.binary_search(&instance).map_or(0, |s| self.kept.sent[s])
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
        near.0.clear();
        let found = &mut near.0;
        if self.placed {
            let range = self.channel.range.unwrap_or(f64::INFINITY);
            let distance = |at: [f64; 3]| {
                let d = [at[0] - place[0], at[1] - place[1], at[2] - place[2]];
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
            };
            let found = std::cell::RefCell::new(found);
            self.grid.around(
                place,
                range,
                |site| {
                    let (mut d, mut slot) = (distance(site.at), site.message);
                    if d > range * range || site.sender == receiver {
                        return;
                    }
                    if self.channel.loss > 0.0 {
                        match self.received(slot as usize / self.ring, receiver, now) {
                            Some(s) => slot = s as u32,
                            None => return,
                        }
                        d = distance(self.kept.stamps[slot as usize].place);
                        if d > range * range {
                            return;
                        }
                    }
                    found.borrow_mut().push((d, site.sender, slot));
                },
                |seen| {
                    let found = found.borrow();
                    found.len() > capacity && found.iter().filter(|f| f.0 <= seen * seen).count() > capacity
                },
            );
            let found = found.into_inner();
            if found.len() > capacity {
                let order =
                    |a: &(f64, u32, u32), b: &(f64, u32, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
                if capacity > 0 {
                    found.select_nth_unstable_by(capacity - 1, order);
                }
                found.truncate(capacity);
                found.sort_unstable_by(order);
            } else {
                found.sort_unstable_by_key(|f| f.1);
            }
        } else {
            for (s, &sender) in self.senders.iter().enumerate() {
                if found.len() == capacity {
                    break;
                }
                if sender != receiver
                    && let Some(slot) = self.received(s, receiver, now)
                {
                    found.push((0.0, s as u32, slot as u32));
                }
            }
        }
        out.fill(0.0);
        let Some((count, items)) = out.split_first_mut() else { return };
        *count = near.0.len() as f64;
        for (item, &(_, _, slot)) in items.chunks_exact_mut(width).zip(&near.0) {
            let at = slot as usize * self.channel.width;
            item.copy_from_slice(&self.kept.registers[at..at + self.channel.width]);
            if let Some(records) = records.as_deref_mut() {
                records.push(self.kept.stamps[slot as usize].record);
            }
        }
    }

    fn received(&self, s: usize, receiver: u32, now: Time) -> Option<usize> {
        let sender = self.senders[s];
        self.newest(s, now, |number| !self.lost(sender, receiver, number))
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
