//! Inputs of stage 3, and meshes on a device.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

pub(crate) mod takeout;

use crate::vulkan_support::{self, Gpu};
use glam::DVec2;
use polder_dualize::reference;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_mesh::GhostMesh;
use polder_tests::families;
use polder_voronoi::{GridMapping, Options, Resolution};
use polder_vulkan::{Kernel, Shader};

/// What stage 3 is given.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) points: Vec<DVec2>,
    pub(crate) order: Vec<u32>,
    pub(crate) pixels: Vec<[u16; 2]>,
    pub(crate) mapping: GridMapping,
    /// The dualized mesh.
    pub(crate) mesh: GhostMesh,
    pub(crate) centers: Vec<DVec2>,
    /// The points in the new order.
    pub(crate) truth: Vec<DVec2>,
}

pub(crate) fn case(name: String, points: &[DVec2], options: &Options) -> Case {
    let voronoi = polder_voronoi::reference::diagram(points, options).unwrap();
    let sites = voronoi.sites;
    let mesh = reference::dualize(&voronoi.diagram, &sites).unwrap().mesh;
    let centers = sites.pixels[..sites.count].iter().map(|p| voronoi.mapping.center(p.map(u32::from))).collect();
    Case {
        name,
        points: points.to_vec(),
        truth: sites.order.iter().map(|&i| points[i as usize]).collect(),
        order: sites.order,
        pixels: sites.pixels,
        mapping: voronoi.mapping,
        mesh,
        centers,
    }
}

pub(crate) fn cases() -> Vec<Case> {
    let options: [Options; 2] = [Options::default(), Resolution::LongerSide(30).into()];
    let all = |(options, seed)| {
        families(500, seed).into_iter().map(move |(name, pslg)| case(name.to_owned(), pslg.points(), &options))
    };
    options.into_iter().zip([41, 42]).flat_map(all).chain(arcs()).collect()
}

/// Few points on flat arcs, of which so many are pinned that a chain is left, or nothing.
pub(crate) fn arcs() -> Vec<Case> {
    let all = (0..2000).map(|seed| {
        let words = vulkan_support::words(seed, 16);
        let unit = |i: usize| f64::from(words[i]) / 2f64.powi(32);
        let (bend, tilt) = (0.2 * unit(0), unit(1) - 0.5);
        let arc = |i| DVec2::new(unit(i), bend * unit(i) * (unit(i) - 1.0) + tilt * unit(i));
        let points: Vec<DVec2> = (4..7 + seed as usize % 8).map(arc).collect();
        case(format!("arc {seed}"), &points, &Resolution::LongerSide(4 + words[2] % 12).into())
    });
    let shifted = all.filter(|case| case.mesh.finite().next().is_some()).map(|case| {
        let shifted = reference::shift(case.mesh.clone(), &case.centers, &case.truth).unwrap();
        (shifted.mesh.finite().count(), shifted.mesh.slots(), case)
    });
    let (empty, chains): (Vec<_>, Vec<_>) =
        shifted.filter(|&(finite, ..)| finite == 0).partition(|&(_, slots, _)| slots == 0);
    assert!(empty.len() > 1 && chains.len() > 4, "{} {}", empty.len(), chains.len());
    empty.into_iter().take(10).chain(chains.into_iter().take(10)).map(|(_, _, case)| case).collect()
}

pub(crate) fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list
}

pub(crate) struct Device {
    pub(crate) gpu: Gpu,
}

pub(crate) struct Held {
    pub(crate) mesh: Mesh,
    pub(crate) sites: usize,
}

impl Device {
    pub(crate) fn open() -> Self {
        Self { gpu: Gpu::open() }
    }

    pub(crate) fn arithmetics(&self) -> [Arithmetic; 2] {
        [Arithmetic::Filtered, Arithmetic::Integers]
    }

    pub(crate) fn hold(&mut self, mesh: &GhostMesh, positions: &[DVec2]) -> Held {
        let held = Mesh::new(&self.gpu.device, positions.len()).unwrap();
        held.upload(&mut self.gpu.engine, mesh, positions).unwrap();
        Held { mesh: held, sites: positions.len() }
    }

    /// In a few workgroups, which have to stride.
    pub(crate) fn run<S: Shader>(&mut self, arguments: &S::Args<'_>) {
        let kernel = Kernel::<S>::new(&self.gpu.device, &[]).unwrap();
        let mut recording = self.gpu.recording();
        recording.dispatch(&kernel, [3, 1, 1], arguments);
        self.gpu.run(&recording);
    }

    /// A kernel that asks predicates.
    pub(crate) fn run_deciding<S: Shader>(&mut self, arithmetic: Arithmetic, arguments: &S::Args<'_>) {
        let kernel = arithmetic.kernel::<S>(&self.gpu.device, &[]).unwrap();
        let mut recording = self.gpu.recording();
        recording.dispatch(&kernel, [3, 1, 1], arguments);
        self.gpu.run(&recording);
    }

    /// A kernel that leaves what its filter does not know to another.
    pub(crate) fn run_both<S: Shader>(
        &mut self,
        arithmetic: Arithmetic,
        few: u32,
        first: &S::Args<'_>,
        again: &S::Args<'_>,
    ) {
        if arithmetic == Arithmetic::Integers {
            return self.run_deciding::<S>(arithmetic, first);
        }
        let filter = Kernel::<S>::new(&self.gpu.device, &[("ARITHMETIC", 0), ("FEW", few)]).unwrap();
        let rest = arithmetic.kernel::<S>(&self.gpu.device, &[("WORKGROUP", 32)]).unwrap();
        let mut recording = self.gpu.recording();
        recording.dispatch(&filter, [3, 1, 1], first);
        recording.dispatch(&rest, [3, 1, 1], again);
        self.gpu.run(&recording);
    }
}
