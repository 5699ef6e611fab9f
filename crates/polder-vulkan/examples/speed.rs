//! How fast the primitives and transfers are on a device: medians of ten, by timestamps and by the clock, checked against
//! the reference once a size. `speed [millions of elements]...`; `POLDER_DEVICE` names the device.

use polder_vulkan::primitives::{Compact, Copier, Operation, Reduce, Scan, Sort, SortShape};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Error, Recording, RunOptions, Timings, reference};
use std::time::{Duration, Instant};

const RUNS: usize = 10;
const WARM_UP: Duration = Duration::from_millis(500);

fn main() -> Result<(), Error> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    println!("{}", device.self_test()?);
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    for millions in if sizes.is_empty() { vec![10] } else { sizes } {
        size(&device, millions * 1_000_000)?;
    }
    Ok(())
}

fn random(len: usize) -> Vec<u64> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state ^ (state >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9)
    };
    (0..len).map(|_| next()).collect()
}

/// Median by the clock, median of the sum of kernels, and the timings of one run.
fn measure(
    engine: &mut Engine,
    recording: &Recording,
    mut before: impl FnMut(&mut Engine) -> Result<(), Error>,
) -> Result<(Duration, Duration, Timings), Error> {
    let (mut clock, mut kernels, mut last) = (Vec::new(), Vec::new(), Timings::default());
    // A card that has waited for the host runs slowly at first.
    let start = Instant::now();
    while start.elapsed() < WARM_UP {
        engine.run(recording, &RunOptions::default())?;
    }
    for _ in 0..=RUNS {
        before(engine)?;
        let start = Instant::now();
        engine.run(recording, &RunOptions::default())?;
        clock.push(start.elapsed());
        before(engine)?;
        last = engine.run(recording, &RunOptions { timestamps: true, ..RunOptions::default() })?.timings;
        kernels.push(last.total());
    }
    clock.sort();
    kernels.sort();
    Ok((clock[RUNS / 2], kernels[RUNS / 2], last))
}

fn say(name: &str, bytes: usize, (clock, kernels, timings): &(Duration, Duration, Timings)) {
    let ms = |time: &Duration| time.as_secs_f64() * 1e3;
    let rate = bytes as f64 / kernels.as_secs_f64() / 1e12;
    println!("{name:<34} {:>9.4} ms by kernels {:>9.4} ms with wait {rate:>6.2} TB/s", ms(kernels), ms(clock));
    for (kernel, timing) in timings.iter() {
        println!(
            "    {kernel:<30} {:>5} x {:>9.4} ms",
            timing.count,
            timing.total_ns as f64 / 1e6 / timing.count as f64
        );
    }
}

fn size(device: &Device, len: usize) -> Result<(), Error> {
    println!("\n{len} elements");
    let mut engine = Engine::new(device)?;
    let wide = random(len);
    let words: Vec<u32> = wide.iter().map(|word| *word as u32).collect();
    let nothing = |_: &mut Engine| Ok(());

    let (from, to) = (Buffer::<u32>::new(device, "from", len)?, Buffer::<u32>::new(device, "to", len)?);
    for turn in ["first", "second"] {
        let start = Instant::now();
        engine.upload(from.view(), &words)?;
        let up = start.elapsed().as_secs_f64();
        let mut back = vec![0; len];
        let start = Instant::now();
        engine.download(from.view(), &mut back)?;
        let down = start.elapsed().as_secs_f64();
        let rate = |seconds: f64| 4e-9 * len as f64 / seconds;
        println!(
            "upload {:.1} GB/s, download {:.1} GB/s ({turn} time), equal: {}",
            rate(up),
            rate(down),
            back == words
        );
    }

    let total = Buffer::<u32>::new(device, "total", 4)?;
    let scan = Scan::new(device, len)?;
    let mut recording = Recording::new(device);
    scan.record(&mut recording, len, from.view(), to.view(), Some(total.view()));
    say("scan", 12 * len, &measure(&mut engine, &recording, nothing)?);
    println!("    equal: {}", engine.download_vec(to.view())? == reference::exclusive_scan(&words).0);

    let compact = Compact::new(device, len)?;
    let mut recording = Recording::new(device);
    compact.record(&mut recording, len, from.view(), None, to.view(), total.view());
    say("compact, all kept", 12 * len, &measure(&mut engine, &recording, nothing)?);

    let reduce = Reduce::<u32>::new(device, Operation::Minimum)?;
    let mut recording = Recording::new(device);
    reduce.record(&mut recording, len, from.view(), total.view());
    say("reduce", 4 * len, &measure(&mut engine, &recording, nothing)?);

    let copier = Copier::new(device)?;
    let mut recording = Recording::new(device);
    copier.record(&mut recording, from.view(), to.view());
    say("copy", 8 * len, &measure(&mut engine, &recording, nothing)?);

    let keys = Buffer::<u64>::new(device, "keys", len)?;
    let order: Vec<u32> = (0..len as u32).collect();
    let best = SortShape::for_device::<u64>(device);
    let mut shapes = vec![best];
    for (workgroup, items) in [(256, 8), (256, 12), (256, 16), (512, 6), (512, 10), (1024, 4)] {
        let shape = SortShape { workgroup, items };
        let pool = 4 * (workgroup * items * 2).max(256 * workgroup / device.info().limits.subgroup);
        if len <= 10_000_000
            && pool + 2048 <= device.info().limits.shared_bytes
            && workgroup <= device.info().limits.workgroup_invocations
        {
            shapes.push(shape);
        }
    }
    for shape in shapes {
        let sort = Sort::<u64>::with_shape(device, len, shape)?;
        let mut recording = Recording::new(device);
        sort.record(&mut recording, len, keys.view(), Some(from.view()), 64);
        let name = format!("sort u64 + u32, {} x {}", shape.workgroup, shape.items);
        let load = |engine: &mut Engine| {
            engine.upload(keys.view(), &wide)?;
            engine.upload(from.view(), &order)
        };
        say(&name, 8 * 32 * len, &measure(&mut engine, &recording, load)?);
        let (sorted, values) = (engine.download_vec(keys.view())?, engine.download_vec(from.view())?);
        let in_order = (1..len).all(|i| (sorted[i - 1], values[i - 1]) < (sorted[i], values[i]));
        let same = in_order && sorted.iter().zip(&values).all(|(key, value)| wide[*value as usize] == *key);
        println!("    sorted stably: {same}");
    }

    let sort = Sort::<u32>::new(device, len)?;
    let mut recording = Recording::new(device);
    sort.record(&mut recording, len, from.view(), Some(to.view()), 32);
    let load = |engine: &mut Engine| engine.upload(from.view(), &words);
    say("sort u32 + u32", 4 * 20 * len, &measure(&mut engine, &recording, load)?);
    Ok(())
}
