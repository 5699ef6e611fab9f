//! What the tests share: exact arithmetic to compare with, and families of points that are hard in different ways.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses a part")]
#![allow(clippy::unwrap_used, reason = "tests")]

use dashu::integer::IBig;
use dashu::rational::RBig;
use glam::{DVec2, dvec2};
use polder_predicates::Sign;

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// From `low` to `high`, both included.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize]
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i as u64 + 1) as usize);
        }
    }

    /// Any finite number, all exponents alike, zeros of both signs now and then.
    pub fn any(&mut self) -> f64 {
        if self.below(16) == 0 {
            return self.pick(&[0.0, -0.0, f64::MAX, -f64::MAX, f64::MIN_POSITIVE, 5e-324, -5e-324]);
        }
        loop {
            let x = f64::from_bits(self.next());
            if x.is_finite() {
                return x;
            }
        }
    }
}

/// `x * 2^exponent`, rounded only if it must be.
pub fn ldexp(x: f64, exponent: i32) -> f64 {
    let (mut x, mut exponent) = (x, exponent);
    while exponent != 0 {
        let step = exponent.clamp(-1000, 1000);
        x *= 2.0_f64.powi(step);
        exponent -= step;
    }
    x
}

/// `x` in units of 2^-1074: an integer.
fn exact(x: f64) -> IBig {
    let bits = x.to_bits();
    let biased = (bits >> 52) & 0x7ff;
    assert!(biased != 0x7ff);
    let mantissa = (bits & ((1 << 52) - 1)) | (u64::from(biased != 0) << 52);
    let magnitude = IBig::from(mantissa) << (biased.max(1) - 1) as usize;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

fn sign_of(x: &IBig) -> Sign {
    match x.cmp(&IBig::ZERO) {
        std::cmp::Ordering::Less => Sign::Negative,
        std::cmp::Ordering::Equal => Sign::Zero,
        std::cmp::Ordering::Greater => Sign::Positive,
    }
}

/// The orientation by big integers, expanded without translation.
pub fn exact_orient2d(p: [DVec2; 3]) -> Sign {
    let [(ax, ay), (bx, by), (cx, cy)] = p.map(|p| (exact(p.x), exact(p.y)));
    let minor = |px: &IBig, py: &IBig, qx: &IBig, qy: &IBig| px * qy - py * qx;
    sign_of(&(minor(&ax, &ay, &bx, &by) + minor(&bx, &by, &cx, &cy) + minor(&cx, &cy, &ax, &ay)))
}

/// The in-circle determinant by big integers.
pub fn exact_incircle(p: [DVec2; 4]) -> Sign {
    let [a, b, c, d] = p.map(|p| (exact(p.x), exact(p.y)));
    let [a, b, c] = [a, b, c].map(|(x, y)| (x - &d.0, y - &d.1));
    let term = |p: &(IBig, IBig), q: &(IBig, IBig), r: &(IBig, IBig)| {
        (&p.0 * &p.0 + &p.1 * &p.1) * (&q.0 * &r.1 - &q.1 * &r.0)
    };
    sign_of(&(term(&a, &b, &c) + term(&b, &c, &a) + term(&c, &a, &b)))
}

/// The in-circle determinant by rational numbers, from the matrix of four rows.
pub fn rational_incircle(p: [DVec2; 4]) -> Sign {
    let rows = p.map(|p| {
        let (x, y) = (RBig::try_from(p.x).unwrap(), RBig::try_from(p.y).unwrap());
        let z = &x * &x + &y * &y;
        (x, y, z)
    });
    let bracket = |i: usize, j: usize, k: usize| {
        let [p, q, r] = [&rows[i], &rows[j], &rows[k]];
        (&q.0 - &p.0) * (&r.1 - &p.1) - (&q.1 - &p.1) * (&r.0 - &p.0)
    };
    let value = &rows[0].2 * bracket(1, 2, 3) - &rows[1].2 * bracket(0, 2, 3) + &rows[2].2 * bracket(0, 1, 3)
        - &rows[3].2 * bracket(0, 1, 2);
    match value.cmp(&RBig::ZERO) {
        std::cmp::Ordering::Less => Sign::Negative,
        std::cmp::Ordering::Equal => Sign::Zero,
        std::cmp::Ordering::Greater => Sign::Positive,
    }
}

/// What plain f64 makes of it: the seeded mistake that the families must reveal.
pub fn naive_orient2d([a, b, c]: [DVec2; 3]) -> Sign {
    let value = (a - c).perp_dot(b - c);
    if value > 0.0 {
        Sign::Positive
    } else if value < 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}

/// What plain f64 makes of it.
pub fn naive_incircle([a, b, c, d]: [DVec2; 4]) -> Sign {
    let (a, b, c) = (a - d, b - d, c - d);
    let value =
        a.length_squared() * b.perp_dot(c) + b.length_squared() * c.perp_dot(a) + c.length_squared() * a.perp_dot(b);
    if value > 0.0 {
        Sign::Positive
    } else if value < 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}

/// All integer points on the circle of radius 1105 about the origin.
pub fn pythagorean() -> Vec<(i64, i64)> {
    let r = 1105_i64;
    let points: Vec<_> = (-r..=r)
        .flat_map(|x| {
            let y = ((r * r - x * x) as f64).sqrt().round() as i64;
            (x * x + y * y == r * r).then_some([(x, y), (x, -y)])
        })
        .flatten()
        .collect();
    assert!(points.len() >= 60);
    points
}

/// A family of quadruples: its name, its points, and whether plain f64 gets some orientation, some in-circle sign wrong.
pub struct Family {
    pub name: &'static str,
    pub quadruples: Vec<[DVec2; 4]>,
    pub naive_orient2d_fails: bool,
    pub naive_incircle_fails: bool,
}

/// A move by a few units in the last place.
fn nudged(random: &mut Random, x: f64) -> f64 {
    match random.below(5) {
        0 => x.next_up(),
        1 => x.next_down(),
        2 => x.next_up().next_up(),
        _ => x,
    }
}

fn nudged_point(random: &mut Random, p: DVec2) -> DVec2 {
    dvec2(nudged(random, p.x), nudged(random, p.y))
}

/// The families, `n` quadruples each.
pub fn families(n: usize, seed: u64) -> Vec<Family> {
    let mut list = Vec::new();
    let mut random = Random(seed);
    let mut add = |name, fails: (bool, bool), make: &mut dyn FnMut(&mut Random) -> [DVec2; 4]| {
        let quadruples = (0..n).map(|_| make(&mut random)).collect();
        list.push(Family { name, quadruples, naive_orient2d_fails: fails.0, naive_incircle_fails: fails.1 });
    };
    use std::array::from_fn;

    add("random", (false, false), &mut |r| from_fn(|_| dvec2(r.unit(), r.unit())));
    add("quantized to 2^-10", (false, false), &mut |r| {
        from_fn(|_| dvec2(r.integer(-50, 50) as f64, r.integer(0, 99) as f64) / 1024.0)
    });
    add("lattice", (false, false), &mut |r| {
        let corner = dvec2(r.integer(0, 999) as f64, r.integer(0, 999) as f64);
        let (x, y) = (r.integer(1, 2) as f64, r.integer(1, 2) as f64);
        let mut square = [corner, corner + dvec2(x, 0.0), corner + dvec2(x, y), corner + dvec2(0.0, y)];
        r.shuffle(&mut square);
        square
    });
    add("lattice of 0.1", (true, true), &mut |r| {
        let (i, j) = (r.integer(0, 99), r.integer(0, 99));
        let p = |i: i64, j: i64| dvec2(i as f64 * 0.1, j as f64 * 0.1);
        if r.below(2) == 0 {
            [p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)]
        } else {
            [p(i, j), p(i + 1, j + 1), p(i + 2, j + 2), p(i + 1, j)]
        }
    });
    let circle = pythagorean();
    add("integer circle", (false, false), &mut |r| {
        let shift = dvec2(r.integer(-5000, 5000) as f64, r.integer(-5000, 5000) as f64);
        let scale = ldexp(1.0, r.integer(-30, 30) as i32);
        from_fn(|_| {
            let (x, y) = r.pick(&circle);
            (dvec2(x as f64, y as f64) + shift) * scale
        })
    });
    add("integer circle far away", (false, false), &mut |r| {
        let far = (1_i64 << 44) as f64;
        from_fn(|_| {
            let (x, y) = r.pick(&circle);
            let near = r.integer(0, 20) / 20;
            dvec2((x + near) as f64 * 1024.0 + far, y as f64 * 1024.0 - far)
        })
    });
    add("rounded circle", (false, true), &mut |r| {
        from_fn(|_| {
            let (sin, cos) = (r.unit() * std::f64::consts::TAU).sin_cos();
            dvec2(cos, sin) * 3.0 + dvec2(10.0, 0.1)
        })
    });
    add("one ulp off a square", (false, true), &mut |r| {
        let square = [dvec2(0.1, 0.1), dvec2(0.7, 0.1), dvec2(0.7, 0.7), dvec2(0.1, 0.7)];
        square.map(|p| nudged_point(r, p))
    });
    add("one ulp off a line", (true, true), &mut |r| {
        let line = [dvec2(0.5, 0.5), dvec2(12.0, 12.0), dvec2(24.0, 24.0), dvec2(0.75, 0.75)];
        line.map(|p| nudged_point(r, p))
    });
    add("collinear integers", (false, false), &mut |r| {
        let step = dvec2(r.integer(-99, 99) as f64, r.integer(-99, 99) as f64);
        from_fn(|_| step * r.integer(-999, 999) as f64)
    });
    add("near a line", (true, true), &mut |r| {
        from_fn(|_| {
            let t = r.unit();
            dvec2(t, t * 0.3 + 0.1)
        })
    });
    add("cluster of 2^-45", (false, false), &mut |r| {
        from_fn(|_| dvec2(0.3, 0.6) + dvec2(r.unit(), r.unit()) * ldexp(1.0, -45))
    });
    add("subnormal integers", (true, true), &mut |r| {
        from_fn(|_| dvec2(r.integer(-9, 9) as f64, r.integer(-9, 9) as f64) * 5e-324)
    });
    add("subnormal", (true, true), &mut |r| from_fn(|_| dvec2(r.unit(), r.unit()) * 1e-310));
    add("1e-300", (true, true), &mut |r| from_fn(|_| dvec2(r.unit(), r.unit()) * 1e-300));
    add("products near the smallest double", (false, true), &mut |r| {
        from_fn(|_| dvec2(r.integer(-9, 9) as f64, r.integer(-9, 9) as f64) * ldexp(1.0, -270))
    });
    add("1e300", (true, true), &mut |r| from_fn(|_| dvec2(r.unit(), r.unit()) * 1e300));
    add("products near the largest double", (false, true), &mut |r| {
        from_fn(|_| dvec2(r.unit() - 0.5, r.unit() - 0.5) * ldexp(1.0, r.integer(254, 257) as i32))
    });
    add("corners of the whole range", (true, true), &mut |r| {
        let ends = [f64::MAX, -f64::MAX, f64::MAX.next_down(), 0.0, -0.0, 5e-324, -5e-324];
        from_fn(|_| dvec2(r.pick(&ends), r.pick(&ends)))
    });
    add("all exponents", (true, true), &mut |r| from_fn(|_| dvec2(r.any(), r.any())));
    add("neighboring exponents", (false, true), &mut |r| {
        let base = r.integer(-1000, 950) as i32;
        let coordinate = |r: &mut Random| ldexp(r.unit() - 0.5, base + r.integer(0, 70) as i32);
        from_fn(|_| dvec2(coordinate(r), coordinate(r)))
    });
    add("a square with a stray 1e-200", (false, true), &mut |r| {
        let mut square = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
        let k = r.below(4) as usize;
        for x in [&mut square[k].x, &mut square[k].y] {
            if *x == 0.0 && r.below(2) == 0 {
                *x = r.pick(&[1e-200, -1e-200, 5e-324, -1e-17, 1e-100]);
            }
        }
        square
    });
    add("edges of the windows", (false, true), &mut |r| {
        let top = r.pick(&[-1022, -1015, -1014, -141, -140, 28, 60, 198, 199, 200, 998, 999, 1000]);
        let depth = r.pick(&[27, 28, 29, 30, 58, 59, 60, 61, 338, 339, 340]);
        let coordinate = |r: &mut Random| match r.below(4) {
            0 => ldexp(1.0, (top - depth).max(-1074)),
            1 => 0.0,
            2 => -ldexp(1.0, top),
            _ => ldexp(1.0, top) + ldexp(1.0, (top - depth).max(-1074)),
        };
        from_fn(|_| dvec2(coordinate(r), coordinate(r)))
    });
    for (name, bits) in [("corners of 29 bits", 29), ("corners of 53 bits", 53)] {
        add(name, (true, true), &mut |r| {
            let most = ldexp(1.0, bits) - 1.0;
            let ends = [most, -most, most - 1.0, 1.0 - most, 0.0, 1.0];
            from_fn(|_| dvec2(r.pick(&ends), r.pick(&ends)))
        });
    }
    add("few distinct values", (true, true), &mut |r| {
        let values = [0.0, -0.0, 1.0, -1.0, 1e10];
        from_fn(|_| dvec2(r.pick(&values), r.pick(&values)))
    });
    add("mixed magnitudes", (true, true), &mut |r| from_fn(|_| mixed_magnitudes(r)));
    add("three points together and one far away", (true, true), &mut |r| {
        let base = r.integer(-1000, 300) as i32;
        let far = base + r.integer(300, 700) as i32;
        let point = |r: &mut Random, e| dvec2(ldexp(r.unit() - 0.5, e), ldexp(r.unit() - 0.5, e));
        let mut q = [point(r, base), point(r, base), point(r, base), point(r, far)];
        r.shuffle(&mut q);
        q
    });
    add("near a line, x far larger than y", (true, true), &mut |r| {
        from_fn(|_| {
            let t = r.unit();
            dvec2(ldexp(t, 300), ldexp(t * 0.3 + 0.1, -300))
        })
    });
    list
}

/// Coordinates of either sign and of any magnitude from 2^-1000 to 2^1000, exponents uniform.
pub fn mixed_magnitudes(random: &mut Random) -> DVec2 {
    let mut coordinate = || ldexp(random.pick(&[-1.0, 1.0]) * (1.0 + random.unit()), random.integer(-1000, 999) as i32);
    dvec2(coordinate(), coordinate())
}

/// The 24 orders of four things, each with whether it is even.
pub fn permutations() -> Vec<([usize; 4], bool)> {
    let mut list = Vec::new();
    for code in 0..256_usize {
        let p = [code & 3, (code >> 2) & 3, (code >> 4) & 3, code >> 6];
        let inversions: usize = (0..4).map(|i| (0..i).filter(|&j| p[j] > p[i]).count()).sum();
        if (0..4).all(|i| p.contains(&i)) {
            list.push((p, inversions.is_multiple_of(2)));
        }
    }
    assert_eq!(list.len(), 24);
    list
}
