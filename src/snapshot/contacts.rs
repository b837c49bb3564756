//! Pairs and their contacts, in as few words as each needs.
//!
//! A pair is its two colliders, in one word if there are few enough of them, and a byte of flags. A contact
//! is a word of flags for the words that follow: zeros, normals along an axis, and numbers that will not be
//! read are left out; everything else is kept to the bit.

use crate::broad_phase::Pair;
use crate::error::Error;
use crate::limits;
use crate::memory::Allowance;
use crate::narrow_phase::{Contact, ContactRef, Contacts, MAX_POINTS, NO_CONTACT, Point, UNKNOWN_LOAD};
use crate::words::{Packer, Reader, all_loads, broken, byte, record, words};
use glam::Vec3;

/// Flags of a pair. Bits 2 to 7 are free for more.
const FAST: u8 = 1;
const TOUCHED: u8 = 1 << 1;
/// The begin of the touch was reported as an event.
const HEARD: u8 = 1 << 2;

/// Flags of a contact, above the number of its points.
const PUSHED: u32 = 1 << 3;
/// Mean forces: steps vary in length.
const MEANS: u32 = 1 << 4;
/// Another contact of the same pair follows.
const MORE: u32 = 1 << 5;
const FRACTION: u32 = 1 << 6;
/// Friction and twist.
const RUBS: u32 = 1 << 7;
/// Three bits: 0 for a normal of three numbers, else 1 + 2 * axis, and one more if it points backwards.
const NORMAL: u32 = 8;
/// Where it was found, because it may be kept in the next step.
const FOUND: u32 = 1 << 11;
/// Separations are not those of where it was found.
const MOVED: u32 = 1 << 12;
/// Two bits: how keys are written.
const KEYS: u32 = 13;
/// Four bits: which points have an impulse.
const LOADED: u32 = 15;
/// Lasting force and static load.
const LASTS: u32 = 1 << 19;
/// How the points share that force, if not evenly.
const SHARES: u32 = 1 << 20;
/// An angular impulse against rolling.
const ROLLING: u32 = 1 << 21;
/// The material is not the shape's own.
const MATERIAL: u32 = 1 << 22;
/// Eight bits: the key of a single point.
const KEY: u32 = 24;

/// Ways to write keys: in the flags, four or two to a word, or a word each.
const KEY_IN_FLAGS: u32 = 0;
const KEYS_OF_8: u32 = 1;
const KEYS_OF_16: u32 = 2;
const KEYS_OF_32: u32 = 3;

/// The most words that a contact takes.
const MAX_CONTACT_WORDS: usize = 1 + 1 + 1 + 3 + 4 + 3 + 3 + 11 + MAX_POINTS * 9 + 4;

/// Whether two colliders fit into one word.
pub(super) fn is_narrow(slots: usize) -> bool {
    slots <= 1 << 16
}

/// Writes the colliders of pairs, then their flags.
pub(super) fn save_pairs<'a, I: Iterator<Item = &'a Pair>>(
    pairs: &dyn Fn() -> I,
    slots: usize,
    out: &mut Vec<u32>,
) -> u32 {
    let before = out.len();
    if is_narrow(slots) {
        pairs().for_each(|pair| out.push(pair.a | pair.b << 16));
    } else {
        pairs().for_each(|pair| out.extend_from_slice(&[pair.a, pair.b]));
    }
    let count = (out.len() - before) / if is_narrow(slots) { 1 } else { 2 };
    let mut flags = Packer::default();
    pairs().for_each(|pair| {
        let fast = if pair.fast { FAST } else { 0 };
        let heard = if pair.touching { HEARD } else { 0 };
        flags.push(out, fast | heard | if pair.contact == NO_CONTACT { 0 } else { TOUCHED });
    });
    flags.end(out);
    count as u32
}

/// Whether the next step may keep the contacts of a pair as they are, by the first of them; see `recycle` in
/// `collide.rs`.
fn may_be_kept(first: ContactRef<'_>) -> bool {
    first.fraction == 0.0 && first.count > 0
}

/// Writes the contacts of pairs, each with whether it may rest: the contact of a body that sleeps is kept as
/// it is, and is told of by where it was found.
pub(super) fn save_contacts<'a>(
    pairs: impl Iterator<Item = (&'a Pair, bool)>,
    contacts: &Contacts,
    out: &mut Vec<u32>,
) -> u32 {
    let mut count = 0;
    for (pair, rests) in pairs.filter(|(pair, _)| pair.contact != NO_CONTACT) {
        let kept = rests || may_be_kept(contacts.at(pair.contact));
        for (slot, contact) in contacts.chain(pair.contact) {
            save_contact(contact, contacts.rolling(slot), kept, out);
            count += 1;
        }
    }
    count
}

fn is_zero<const N: usize>(words: [u32; N]) -> bool {
    words == [0; N]
}

/// The code of a normal along an axis; 0 of any other.
fn axis_of(normal: Vec3) -> u32 {
    const ONE: u32 = 1.0f32.to_bits();
    const MINUS: u32 = (-1.0f32).to_bits();
    match words::<3>(normal) {
        [ONE, 0, 0] => 1,
        [MINUS, 0, 0] => 2,
        [0, ONE, 0] => 3,
        [0, MINUS, 0] => 4,
        [0, 0, ONE] => 5,
        [0, 0, MINUS] => 6,
        _ => 0,
    }
}

fn axis(code: u32) -> Vec3 {
    let mut normal = Vec3::ZERO;
    normal[(code as usize - 1) / 2] = if code % 2 == 1 { 1.0 } else { -1.0 };
    normal
}

/// The words of one contact, in an array of fixed size: a constant number of words is copied without a call.
struct Line {
    all: [u32; MAX_CONTACT_WORDS],
    len: usize,
    /// The first word: flags of the words that follow.
    flags: u32,
}

impl Line {
    #[inline(always)]
    fn put<const N: usize>(&mut self, words: [u32; N]) {
        self.all[self.len..][..N].copy_from_slice(&words);
        self.len += N;
    }

    #[inline(always)]
    fn flag(&mut self, bit: u32, set: bool) {
        self.flags |= if set { bit } else { 0 };
    }

    /// Words that are left out if all are zero.
    #[inline(always)]
    fn put_some<const N: usize>(&mut self, bit: u32, words: [u32; N]) {
        if words != [0; N] {
            self.flags |= bit;
            self.put(words);
        }
    }

    /// The keys of points, in as few words as the widest needs.
    #[inline(always)]
    fn put_keys(&mut self, points: &[Point]) {
        let widest = points.iter().fold(0, |all, p| all | p.key);
        let how = match (widest, points.len()) {
            (..=0xff, ..=1) => KEY_IN_FLAGS,
            (..=0xff, _) => KEYS_OF_8,
            (..=0xffff, _) => KEYS_OF_16,
            _ => KEYS_OF_32,
        };
        self.flag(how << KEYS, true);
        match how {
            KEY_IN_FLAGS => self.flag(points.first().map_or(0, |p| p.key) << KEY, true),
            KEYS_OF_8 => self.put([points.iter().rev().fold(0, |all, p| all << 8 | p.key)]),
            KEYS_OF_16 => {
                for two in points.chunks(2) {
                    self.put([two[0].key | two.get(1).map_or(0, |p| p.key) << 16]);
                }
            }
            _ => points.iter().for_each(|p| self.put([p.key])),
        }
    }
}

fn save_contact(contact: ContactRef<'_>, rolling: Vec3, kept: bool, out: &mut Vec<u32>) {
    let mut line = Line { all: [0; MAX_CONTACT_WORDS], len: 1, flags: u32::from(contact.count) };
    let points = contact.points();
    line.flag(PUSHED, contact.pushed);
    line.flag(MORE, contact.next != NO_CONTACT);
    line.put_some(FRACTION, [contact.fraction.to_bits()]);
    line.put_some(MATERIAL, [contact.material.into()]);
    let axis = axis_of(contact.normal);
    line.flag(axis << NORMAL, true);
    if axis == 0 {
        line.put(words::<3>(contact.normal));
    }
    line.put_some(RUBS, words::<4>(contact.friction.extend(contact.twist).to_array()));
    line.put_some(ROLLING, words::<3>(rolling));
    // By bits, here and below: a zero may have a sign.
    let lasts = !is_zero([contact.lasting_force, contact.rest].map(f32::to_bits))
        || contact.static_load != UNKNOWN_LOAD;
    line.flag(LASTS, lasts);
    if lasts {
        line.put([contact.lasting_force, contact.rest, contact.static_load].map(f32::to_bits));
    }
    let even = contact.even_share();
    let shares = points.iter().any(|p| p.share != even);
    line.flag(SHARES, shares);
    if shares {
        points.iter().for_each(|p| line.put([p.share.to_bits()]));
    }
    // A contact with lasting loads needs its pose at detection, to measure how far it moved.
    let found = kept || lasts;
    line.flag(FOUND, found);
    if found {
        line.put(words::<3>(contact.found_at.position));
        line.put(words::<4>(contact.found_at.rotation.to_array()));
        line.put(words::<4>(contact.frame.to_array()));
    }
    let moved = found && points.iter().any(|p| p.found.to_bits() != p.separation.to_bits());
    line.flag(MOVED, moved);
    line.put_keys(points);
    for (i, p) in points.iter().enumerate() {
        line.put(words::<4>(p.position.extend(p.separation).to_array()));
        if moved {
            line.put([p.found.to_bits()]);
        }
        line.put_some(1 << (LOADED as usize + i), [p.impulse.to_bits()]);
    }
    let means = words::<4>(contact.mean_friction);
    let has_means = !is_zero(means) || points.iter().any(|p| p.mean_force != 0.0);
    line.flag(MEANS, has_means);
    if has_means {
        line.put(means);
        points.iter().for_each(|p| line.put([p.mean_force.to_bits()]));
    }
    line.all[0] = line.flags;
    out.extend_from_slice(&line.all[..line.len]);
}

/// Saved pairs with their contacts, in their words.
#[derive(Clone, Copy)]
pub(super) struct SavedPairs<'a> {
    narrow: bool,
    colliders: &'a [u32],
    flags: &'a [u32],
    contacts: &'a [u32],
}

impl<'a> SavedPairs<'a> {
    pub(super) fn read(
        from: &mut Reader<'a>,
        count: u32,
        words: u32,
        slots: usize,
    ) -> Result<SavedPairs<'a>, Error> {
        let narrow = is_narrow(slots);
        Ok(SavedPairs {
            narrow,
            colliders: from.table(count, if narrow { 1 } else { 2 })?,
            flags: from.take((count as usize).div_ceil(4))?,
            contacts: from.table(words, 1)?,
        })
    }

    pub(super) fn len(&self) -> usize {
        self.colliders.len() / if self.narrow { 1 } else { 2 }
    }

    fn pair(&self, i: usize) -> (u32, u32) {
        if self.narrow {
            (self.colliders[i] & 0xffff, self.colliders[i] >> 16)
        } else {
            (self.colliders[2 * i], self.colliders[2 * i + 1])
        }
    }

    /// Calls `each` with every pair, whose contacts are added to `contacts` by then, each with place for at
    /// least `room` points of its two colliders.
    pub(super) fn restore(
        &self,
        contacts: &mut Contacts,
        room: &dyn Fn(u32, u32) -> usize,
        mut each: impl FnMut(Pair),
    ) -> Result<(), Error> {
        let mut from = Reader(self.contacts);
        for i in 0..self.len() {
            let ((a, b), flags) = (self.pair(i), byte(self.flags, i));
            let (fast, touching) = (flags & FAST != 0, flags & HEARD != 0);
            let mut pair = Pair { a, b, contact: NO_CONTACT, fast, touching, apart: 0 };
            if flags & TOUCHED != 0 {
                let (mut last, mut more) = (NO_CONTACT, true);
                while more {
                    let read = read_contact(&mut from, (a, b))?;
                    let slot = contacts.restore(&read.contact, room(a, b));
                    contacts.set_rolling(slot, read.rolling, &mut { Allowance::ENDLESS });
                    if last == NO_CONTACT {
                        pair.contact = slot;
                    } else {
                        contacts.at_mut(last).next = slot;
                    }
                    (last, more) = (slot, read.more);
                }
            }
            each(pair);
        }
        Ok(())
    }

    /// The number of points that all contacts have place for, if each has one for at least `room` of its two
    /// colliders.
    pub(super) fn places(&self, room: &dyn Fn(u32, u32) -> usize) -> usize {
        let (mut from, mut points) = (Reader(self.contacts), 0);
        for i in (0..self.len()).filter(|&i| byte(self.flags, i) & TOUCHED != 0) {
            let (a, b) = self.pair(i);
            while let Ok(read) = read_contact(&mut from, (a, b)) {
                points += room(a, b).max(read.contact.count.max(1).into());
                if !read.more {
                    break;
                }
            }
        }
        points
    }

    /// Whether all pairs are some that `may` be, each once, and all contacts are whole: so many of them.
    pub(super) fn check(&self, count: usize, may: impl Fn(usize, u32, u32) -> bool) -> Result<(), Error> {
        let mut from = Reader(self.contacts);
        let (mut found, mut known) = (0, Vec::with_capacity(self.len()));
        for i in 0..self.len() {
            let ((a, b), flags) = (self.pair(i), byte(self.flags, i));
            if flags & !(FAST | TOUCHED | HEARD) != 0 || !may(i, a, b) {
                return Err(broken("a pair"));
            }
            known.push((a, b));
            let mut more = flags & TOUCHED != 0;
            while more {
                let read = read_contact(&mut from, (a, b))?;
                check_contact(read.contact.as_ref())?;
                all_loads(&words::<3>(read.rolling))?;
                found += 1;
                more = read.more;
            }
        }
        known.sort_unstable();
        let twice = known.windows(2).any(|two| two[0] == two[1]);
        if twice || found != count || !from.0.is_empty() { Err(broken("the contacts")) } else { Ok(()) }
    }
}

fn check_contact(contact: ContactRef<'_>) -> Result<(), Error> {
    all_loads(&words::<4>(contact.friction.extend(contact.twist).to_array()))?;
    all_loads(&words::<4>(contact.mean_friction))?;
    all_loads(&[contact.lasting_force, contact.rest, contact.static_load].map(f32::to_bits))?;
    // Points on a plane may be as far from its origin as the bodies on it.
    let near = |v: Vec3| v.abs().max_element() <= 4.0 * limits::MAX_POSITION as f32;
    let unit = |square: f32| (0.9..1.1).contains(&square);
    let point = |p: &Point| {
        let apart = Vec3::new(p.separation, p.found, 0.0);
        !p.position.is_nan()
            && near(p.position)
            && !apart.is_nan()
            && near(apart)
            && (0.0..=1.0).contains(&p.share)
    };
    if !unit(contact.found_at.rotation.length_squared())
        || !unit(contact.frame.length_squared())
        || !unit(contact.normal.length_squared())
        || !(0.0..=1.0).contains(&contact.fraction)
        || contact.found_at.position.is_nan()
        || !near(contact.found_at.position)
        || !contact.points().iter().all(point)
    {
        return Err(broken("a contact"));
    }
    let loads = |p: &Point| all_loads(&[p.impulse, p.mean_force].map(f32::to_bits));
    contact.points().iter().try_for_each(loads)
}

/// A contact of a snapshot.
struct Read {
    contact: Contact,
    rolling: Vec3,
    /// Another of the same pair follows.
    more: bool,
}

/// Reads the next contact.
fn read_contact(from: &mut Reader<'_>, (a, b): (u32, u32)) -> Result<Read, Error> {
    let flags = from.one()?;
    let count = (flags & 7) as usize;
    if count > MAX_POINTS {
        return Err(broken("a contact with too many points"));
    }
    let mut contact = Contact::new(a, b);
    contact.count = count as u8;
    contact.pushed = flags & PUSHED != 0;
    if flags & FRACTION != 0 {
        contact.fraction = f32::from_bits(from.one()?);
    }
    if flags & MATERIAL != 0 {
        let number = u8::try_from(from.one()?).ok().filter(|&number| number > 0);
        contact.material = number.ok_or_else(|| broken("the material of a contact"))?;
    }
    contact.normal = match flags >> NORMAL & 7 {
        0 => from.record::<Vec3, 3>()?,
        7 => return Err(broken("a normal")),
        code => axis(code),
    };
    if flags & RUBS != 0 {
        let [x, y, z, twist]: [f32; 4] = from.record::<_, 4>()?;
        (contact.friction, contact.twist) = (Vec3::new(x, y, z), twist);
    }
    let rolling = if flags & ROLLING != 0 { from.record::<Vec3, 3>()? } else { Vec3::ZERO };
    if flags & LASTS != 0 {
        [contact.lasting_force, contact.rest, contact.static_load] = from.record::<[f32; 3], 3>()?;
    }
    let mut shares = [contact.even_share(); MAX_POINTS];
    if flags & SHARES != 0 {
        let own = from.take(count)?;
        shares.iter_mut().zip(own).for_each(|(share, &bits)| *share = f32::from_bits(bits));
    }
    if flags & FOUND != 0 {
        contact.found_at.position = from.record::<Vec3, 3>()?;
        contact.found_at.rotation = crate::math::Quat::from_array(from.record::<[f32; 4], 4>()?);
        contact.frame = crate::math::Quat::from_array(from.record::<[f32; 4], 4>()?);
    }
    let keys = read_keys(from, flags, count)?;
    for (i, key) in keys.into_iter().enumerate().take(count) {
        let [x, y, z, separation]: [f32; 4] = record::<_, 4>(from.take(4)?);
        let mut point = Point {
            position: Vec3::new(x, y, z),
            separation,
            found: separation,
            key,
            share: shares[i],
            ..Point::default()
        };
        if flags & MOVED != 0 {
            point.found = f32::from_bits(from.one()?);
        }
        if flags >> (LOADED as usize + i) & 1 != 0 {
            point.impulse = f32::from_bits(from.one()?);
        }
        contact.points[i] = point;
    }
    if flags & MEANS != 0 {
        contact.mean_friction = from.record::<[f32; 4], 4>()?;
        for point in &mut contact.points[..count] {
            point.mean_force = f32::from_bits(from.one()?);
        }
    }
    Ok(Read { contact, rolling, more: flags & MORE != 0 })
}

/// The keys of so many points, as [`Line::put_keys`] wrote them.
fn read_keys(from: &mut Reader<'_>, flags: u32, count: usize) -> Result<[u32; MAX_POINTS], Error> {
    let mut keys = [0u32; MAX_POINTS];
    match flags >> KEYS & 3 {
        KEY_IN_FLAGS => keys[0] = flags >> KEY,
        KEYS_OF_8 => {
            let word = from.one()?;
            keys.iter_mut().enumerate().for_each(|(i, key)| *key = word >> (8 * i) & 0xff);
        }
        KEYS_OF_16 => {
            for two in keys[..count].chunks_mut(2) {
                let word = from.one()?;
                two.iter_mut().enumerate().for_each(|(i, key)| *key = word >> (16 * i) & 0xffff);
            }
        }
        _ => keys[..count].copy_from_slice(from.take(count)?),
    }
    Ok(keys)
}
