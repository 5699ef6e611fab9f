//! Which barrier a command needs, from what it and the commands before it touch.
//!
//! A barrier orders all earlier commands of some scopes before all later ones of others. Each use of memory is
//! remembered with the scopes that barriers have ordered after it; a command that conflicts with a use its scope is not
//! ordered after needs a barrier, and the narrowest one is between the scopes that conflict. That keeps a chain of
//! kernels at compute to compute; only an indirect read or a transfer widens it.

use std::collections::HashMap;

/// Who touches memory. A set of scopes is the sum of their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Scope {
    Compute = 1,
    Transfer = 2,
    Indirect = 4,
}

const ALL: u8 = 7;

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
    /// Scopes ordered after it.
    ordered: u8,
}

#[derive(Debug, Default)]
pub(crate) struct Hazards {
    past: HashMap<u64, Vec<Past>>,
}

impl Hazards {
    pub(crate) fn clear(&mut self) {
        self.past.clear();
    }

    /// The barrier that has to stand before a command of these uses, which is then remembered.
    pub(crate) fn before(&mut self, uses: &[Use]) -> Option<Barrier> {
        let mut barrier = Barrier::default();
        for new in uses {
            for past in self.past.get(&new.buffer).into_iter().flatten() {
                let overlap = past.of.start < new.end && new.start < past.of.end;
                if overlap && (past.of.write || new.write) && past.ordered & new.scope as u8 == 0 {
                    barrier.from |= past.of.scope as u8;
                    barrier.to |= new.scope as u8;
                }
            }
        }
        let needed = (barrier != Barrier::default()).then_some(barrier);
        if needed.is_some() {
            for uses in self.past.values_mut() {
                for past in uses.iter_mut().filter(|past| barrier.from & past.of.scope as u8 != 0) {
                    past.ordered |= barrier.to;
                }
                uses.retain(|past| past.ordered != ALL);
            }
            self.past.retain(|_, uses| !uses.is_empty());
        }
        for new in uses.iter().filter(|new| new.start < new.end) {
            let uses = self.past.entry(new.buffer).or_default();
            if new.write {
                // Whoever conflicts with what this covers conflicts with this.
                uses.retain(|past| !(new.start <= past.of.start && past.of.end <= new.end && past.of != *new));
            }
            if !uses.iter().any(|past| past.of == *new && past.ordered == 0) {
                uses.retain(|past| past.of != *new);
                uses.push(Past { of: *new, ordered: 0 });
            }
        }
        needed
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
}
