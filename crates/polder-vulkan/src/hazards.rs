//! Which barrier a command needs, from what it and the commands before it touch.
//!
//! A barrier orders all earlier commands of some scopes before all later ones of others. Commands are numbered. Of each use
//! of memory is remembered which command it was, and of each pair of scopes when a barrier last stood between them: a use is
//! ordered before a scope if that was later. A command that conflicts with a use its scope is not ordered after needs a
//! barrier, and the narrowest one is between the scopes that conflict. That keeps a chain of kernels at compute to compute;
//! only an indirect read or a transfer widens it.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Who touches memory. A set of scopes is the sum of their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Scope {
    Compute = 1,
    Transfer = 2,
    Indirect = 4,
}

/// Scopes, and their bits.
const SCOPES: usize = 3;

fn places(scopes: u8) -> impl Iterator<Item = usize> {
    (0..SCOPES).filter(move |place| scopes & (1 << place) != 0)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Use {
    pub(crate) buffer: u64,
    pub(crate) start: u64,
    pub(crate) end: u64,
    pub(crate) scope: Scope,
    pub(crate) write: bool,
}

/// From these scopes to those.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Barrier {
    pub(crate) from: u8,
    pub(crate) to: u8,
}

#[derive(Debug, Clone, Copy)]
struct Past {
    of: Use,
    /// The command.
    number: u64,
}

/// Buffers are numbered: that spreads them well enough.
#[derive(Debug, Default, Clone, Copy)]
struct ById(u64);

impl Hasher for ById {
    fn finish(&self) -> u64 {
        self.0.wrapping_mul(0x9e37_79b9_7f4a_7c15)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.0 = self.0 << 8 | u64::from(*byte));
    }

    fn write_u64(&mut self, id: u64) {
        self.0 = id;
    }
}

#[derive(Debug, Default)]
pub(crate) struct Hazards {
    past: HashMap<u64, Vec<Past>, BuildHasherDefault<ById>>,
    /// The command that comes next.
    next: u64,
    /// From scope to scope: the command before which a barrier last stood.
    barriers: [[u64; SCOPES]; SCOPES],
}

impl Hazards {
    pub(crate) fn clear(&mut self) {
        self.past.clear();
    }

    /// The barrier that has to stand before a command of these uses, which is then remembered.
    pub(crate) fn before(&mut self, uses: &[Use]) -> Option<Barrier> {
        let number = self.next;
        self.next += 1;
        let mut barrier = Barrier::default();
        let barriers = &self.barriers;
        let is_ordered =
            |past: &Past, to: usize| barriers[(past.of.scope as u8).trailing_zeros() as usize][to] > past.number;
        for new in uses.iter().filter(|new| new.start < new.end) {
            let to = (new.scope as u8).trailing_zeros() as usize;
            for past in self.past.get(&new.buffer).into_iter().flatten() {
                let overlap = past.of.start < new.end && new.start < past.of.end;
                if overlap && (past.of.write || new.write) && !is_ordered(past, to) {
                    barrier.from |= past.of.scope as u8;
                    barrier.to |= new.scope as u8;
                }
            }
        }
        for from in places(barrier.from) {
            for to in places(barrier.to) {
                self.barriers[from][to] = number;
            }
        }
        let uses = uses.iter().filter(|new| new.start < new.end);
        for new in uses.clone().filter(|new| new.write) {
            // Whoever conflicts with what this covers conflicts with this, which is ordered after it.
            let past = self.past.entry(new.buffer).or_default();
            past.retain(|past| !(new.start <= past.of.start && past.of.end <= new.end));
        }
        for new in uses {
            let past = self.past.entry(new.buffer).or_default();
            let barriers = &self.barriers;
            // What was read in the same way before is ordered by whatever orders this.
            past.retain(|past| {
                let row = &barriers[(past.of.scope as u8).trailing_zeros() as usize];
                past.of != *new && row.iter().any(|barrier| *barrier <= past.number)
            });
            past.push(Past { of: *new, number });
        }
        (barrier != Barrier::default()).then_some(barrier)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(buffer: u64, scope: Scope) -> Use {
        Use { buffer, start: 0, end: 64, scope, write: false }
    }

    fn write(buffer: u64, scope: Scope) -> Use {
        Use { write: true, ..read(buffer, scope) }
    }

    const COMPUTE: Barrier = Barrier { from: 1, to: 1 };

    #[test]
    fn no_barrier_without_conflict() {
        let mut hazards = Hazards::default();
        assert_eq!(hazards.before(&[read(0, Scope::Compute), write(1, Scope::Compute)]), None);
        assert_eq!(hazards.before(&[read(0, Scope::Compute), write(2, Scope::Compute)]), None);
        let upper = Use { start: 64, end: 128, ..write(1, Scope::Compute) };
        assert_eq!(hazards.before(&[upper]), None);
    }

    #[test]
    fn compute_to_compute_unless_an_indirect_read_follows() {
        let mut hazards = Hazards::default();
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), None);
        assert_eq!(hazards.before(&[read(0, Scope::Compute), write(1, Scope::Compute)]), Some(COMPUTE));
        // The same write again, now for the indirect read: it was ordered for kernels only.
        assert_eq!(hazards.before(&[read(0, Scope::Indirect)]), Some(Barrier { from: 1, to: 4 }));
        assert_eq!(hazards.before(&[read(0, Scope::Indirect)]), None);
    }

    #[test]
    fn one_barrier_orders_everything_before_it() {
        let mut hazards = Hazards::default();
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), None);
        assert_eq!(hazards.before(&[write(1, Scope::Compute)]), None);
        assert_eq!(hazards.before(&[read(0, Scope::Compute)]), Some(COMPUTE));
        assert_eq!(hazards.before(&[read(1, Scope::Compute)]), None);
    }

    #[test]
    fn a_write_waits_for_reads_and_writes() {
        let mut hazards = Hazards::default();
        assert_eq!(hazards.before(&[read(0, Scope::Transfer)]), None);
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), Some(Barrier { from: 2, to: 1 }));
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), Some(COMPUTE));
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), Some(COMPUTE));
    }

    #[test]
    fn a_small_write_does_not_hide_a_large_one() {
        let mut hazards = Hazards::default();
        let small = Use { end: 16, ..write(0, Scope::Compute) };
        assert_eq!(hazards.before(&[write(0, Scope::Compute)]), None);
        assert_eq!(hazards.before(&[small]), Some(COMPUTE));
        let rest = Use { start: 16, ..read(0, Scope::Compute) };
        assert_eq!(hazards.before(&[rest]), None);
        let rest = Use { start: 16, ..read(0, Scope::Transfer) };
        assert_eq!(hazards.before(&[rest]), Some(Barrier { from: 1, to: 2 }));
        assert_eq!(hazards.before(&[read(0, Scope::Compute)]), Some(COMPUTE));
    }

    /// Against the definition: between two commands that conflict stands a barrier from the scope of the first to the
    /// scope of the second, or a write that covers the first and was ordered after it. And no barrier is wider than the
    /// pairs that had none ask for.
    #[test]
    fn random_commands_are_ordered_and_no_more() {
        let mut state = 1_u64;
        let mut below = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..300 {
            let mut hazards = Hazards::default();
            let mut commands: Vec<Vec<Use>> = Vec::new();
            let mut barriers: Vec<Option<Barrier>> = Vec::new();
            for _ in 0..40 {
                let uses: Vec<Use> = (0..1 + below(3))
                    .map(|_| {
                        let start = 16 * below(6);
                        let scope =
                            [Scope::Compute, Scope::Compute, Scope::Transfer, Scope::Indirect][below(4) as usize];
                        let write = scope != Scope::Indirect && below(2) == 0;
                        Use { buffer: below(3), start, end: start + 16 * below(4), scope, write }
                    })
                    .collect();
                let barrier = hazards.before(&uses);
                let mut needed = Barrier::default();
                for (first, earlier) in commands.iter().enumerate() {
                    for (past, new) in earlier.iter().flat_map(|past| uses.iter().map(move |new| (past, new))) {
                        let overlap = past.start.max(new.start) < past.end.min(new.end) && past.buffer == new.buffer;
                        let covers = |barrier: &Barrier| {
                            barrier.from & past.scope as u8 != 0 && barrier.to & new.scope as u8 != 0
                        };
                        if !overlap || !(past.write || new.write) || barriers[first + 1..].iter().flatten().any(covers)
                        {
                            continue;
                        }
                        // A write between the two that is ordered after the first and covers it stands for it.
                        let stands = (first + 1..commands.len()).any(|middle| {
                            commands[middle].iter().any(|other| {
                                other.write
                                    && other.buffer == past.buffer
                                    && other.start <= past.start
                                    && past.end <= other.end
                            })
                        });
                        assert!(stands || barrier.is_some_and(|barrier| covers(&barrier)), "{past:?} then {new:?}");
                        needed.from |= past.scope as u8;
                        needed.to |= new.scope as u8;
                    }
                }
                if let Some(barrier) = barrier {
                    assert!(barrier.from & !needed.from == 0 && barrier.to & !needed.to == 0, "wider than it must be");
                }
                commands.push(uses);
                barriers.push(barrier);
            }
        }
    }
}
