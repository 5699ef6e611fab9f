//! Stage 1 with everything failing in turn that can fail.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_voronoi::gpu::{FindBounds, Stage};
use polder_voronoi::{Counts, GridMapping, Resolution, reference};
use polder_vulkan::{Buffer, Device, Engine, Error, Recording, RunOptions};
use vulkan_support::faults::fail_everywhere;

/// Points on a thin circle, which leave debris, so that every loop turns.
fn points() -> Vec<polder_voronoi::DVec2> {
    polder_io::generate::circle(300, 5).points().to_vec()
}

/// Order, colors, bits of debris, counts.
type Found = (Vec<u32>, Vec<u32>, Vec<u32>, Counts);

/// Upload, box, the whole stage, and everything that it gives.
fn work(device: &Device) -> Result<Found, Error> {
    let points = points();
    let mut engine = Engine::new(device)?;
    let input = Buffer::new(device, "points", points.len())?;
    engine.upload(input.view(), &points)?;
    let mut recording = Recording::new(device);
    let read = FindBounds::new(device)?.record(&mut recording, input.view())?;
    let report = engine.run(&recording, &RunOptions::default())?;
    let bounds = read.bounds(&report).unwrap();
    let mapping = GridMapping::fit_bounds(&bounds, None, points.len(), &Resolution::LongerSide(70).into()).unwrap();

    let stage = Stage::new(device)?;
    let buffers = stage.buffers(points.len(), mapping.size())?;
    let mut recording = Recording::new(device);
    let read = stage.record(&mut recording, &mapping, input.view(), &buffers)?;
    let report = engine.run(&recording, &RunOptions { timestamps: true, ..RunOptions::default() })?;
    let counts = read.counts(&report);
    let debris = engine.download_vec(buffers.debris_bits()?)?;
    Ok((engine.download_vec(buffers.order())?, engine.download_vec(buffers.colors())?, debris, counts))
}

#[test]
fn every_failure_of_the_stage_is_an_error_and_the_next_call_works() {
    let struck = fail_everywhere(work, |error| Some(error));
    println!("{struck:?}");
    let device = vulkan_support::Gpu::open().device.clone();
    let (order, colors, debris, counts) = work(&device).unwrap();
    let expected = reference::diagram(&points(), &Resolution::LongerSide(70).into()).unwrap();
    assert_eq!((order, colors), (expected.sites.order, expected.diagram.colors));
    assert_eq!((reference::kernels::list_debris(&debris), counts), (expected.diagram.debris, expected.counts));
    assert!(counts.debris > 20, "{counts:?}");
}
