//! Instance, device, queue and allocator that a caller made, lends, uses again afterwards, and destroys: the validation
//! layer, which watches all of it, would name what is used after its end and what is left at the end of the device.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]
#![expect(unsafe_code, reason = "making a device by hand")]

mod vulkan_support;

use glam::DVec2;
use polder_flip::gpu::{Arithmetic, Signs};
use polder_vulkan::ash::{self, ext, vk};
use polder_vulkan::gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use polder_vulkan::primitives::{Scan, Sort};
use polder_vulkan::{
    Buffer, CacheFolder, Device, Engine, Error, Feature, Lent, Recording, RunOptions, SelfTest, requirements,
};
use std::ffi::c_void;
use std::sync::{Arc, Mutex};
use vulkan_support::{Gpu, options, words};

type Messages = Mutex<Vec<String>>;

/// What the caller owns.
struct Owner {
    _entry: ash::Entry,
    instance: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    physical: vk::PhysicalDevice,
    device: ash::Device,
    family: u32,
    messages: Box<Messages>,
}

unsafe extern "system" fn keep(
    _: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer's data is valid during the call; `user` is the box that the owner keeps.
    let (text, messages) = unsafe { ((*data).message_as_c_str(), &*user.cast::<Messages>()) };
    messages.lock().unwrap().push(text.map(|text| text.to_string_lossy().into_owned()).unwrap_or_default());
    vk::FALSE
}

impl Owner {
    fn new(float64: bool) -> Owner {
        let index = Gpu::open().device.info().index;
        let messages = Box::new(Messages::default());
        let validation = options().validation;
        let layers = if validation { vec![c"VK_LAYER_KHRONOS_validation".as_ptr()] } else { Vec::new() };
        let extensions = if validation { vec![ext::debug_utils::NAME.as_ptr()] } else { Vec::new() };
        let severity = vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING;
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(severity)
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
            .pfn_user_callback(Some(keep))
            .user_data(std::ptr::from_ref(&*messages).cast_mut().cast());
        // SAFETY: plain Vulkan, as the specification has it; the features are those that `requirements` names.
        unsafe {
            let entry = ash::Entry::load().unwrap();
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let description = vk::InstanceCreateInfo::default()
                .application_info(&application)
                .enabled_layer_names(&layers)
                .enabled_extension_names(&extensions);
            let instance = entry.create_instance(&description, None).unwrap();
            let messenger = validation.then(|| {
                let loaded = ext::debug_utils::Instance::new(&entry, &instance);
                let made = loaded.create_debug_utils_messenger(&info, None).unwrap();
                (loaded, made)
            });
            let physical = instance.enumerate_physical_devices().unwrap()[index];
            let families = instance.get_physical_device_queue_family_properties(physical);
            let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
            let family = families.iter().position(computes).unwrap() as u32;
            assert_eq!(requirements().features.len(), 7);
            let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default()
                .buffer_device_address(true)
                .timeline_semaphore(true)
                .host_query_reset(true);
            let mut vulkan13 = vk::PhysicalDeviceVulkan13Features::default()
                .synchronization2(true)
                .subgroup_size_control(true)
                .compute_full_subgroups(true);
            let plain = vk::PhysicalDeviceFeatures::default().shader_int64(true).shader_float64(float64);
            let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
            let description = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_features(&plain)
                .push_next(&mut vulkan12)
                .push_next(&mut vulkan13);
            let device = instance.create_device(physical, &description, None).unwrap();
            Owner { _entry: entry, instance, messenger, physical, device, family, messages }
        }
    }

    fn allocator(&self) -> Arc<Mutex<Allocator>> {
        let description = AllocatorCreateDesc {
            instance: self.instance.clone(),
            device: self.device.clone(),
            physical_device: self.physical,
            debug_settings: Default::default(),
            buffer_device_address: true,
            allocation_sizes: Default::default(),
        };
        Arc::new(Mutex::new(Allocator::new(&description).unwrap()))
    }

    fn queue(&self) -> vk::Queue {
        // SAFETY: the device was made with one queue of this family.
        unsafe { self.device.get_device_queue(self.family, 0) }
    }

    fn lend(&self, allocator: Option<Arc<Mutex<Allocator>>>, optional: &[Feature], cap: Option<u64>) -> Device {
        let lent = Lent {
            instance: self.instance.clone(),
            physical: self.physical,
            device: self.device.clone(),
            queue: self.queue(),
            family: self.family,
            optional: optional.to_vec(),
            allocator,
            memory_cap: cap,
            cache: CacheFolder::Off,
        };
        // SAFETY: the handles belong together and outlive all that is made here; the features are enabled; nobody else
        // uses the queue meanwhile.
        unsafe { Device::borrow(lent) }.unwrap()
    }

    /// The owner's own use of its device: an empty submission with a fence.
    fn use_device(&self) {
        // SAFETY: plain Vulkan; the fence is destroyed once the queue is done.
        unsafe {
            let fence = self.device.create_fence(&vk::FenceCreateInfo::default(), None).unwrap();
            self.device.queue_submit(self.queue(), &[], fence).unwrap();
            self.device.wait_for_fences(&[fence], true, u64::MAX).unwrap();
            self.device.destroy_fence(fence, None);
            self.device.device_wait_idle().unwrap();
            assert!(!self.instance.enumerate_physical_devices().unwrap().is_empty());
        }
    }

    /// Ends everything; what the layer said, also about what somebody left behind.
    fn end(mut self) -> Vec<String> {
        // SAFETY: nothing made from the device is left, which the layer checks.
        unsafe {
            self.device.destroy_device(None);
            if let Some((loaded, messenger)) = self.messenger.take() {
                loaded.destroy_debug_utils_messenger(messenger, None);
            }
            self.instance.destroy_instance(None);
        }
        std::mem::take(&mut *self.messages.lock().unwrap())
    }
}

fn work(device: &Device) -> Result<Vec<u32>, Error> {
    let len = 5000;
    let mut engine = Engine::new(device)?;
    let (scan, sort) = (Scan::new(device, len)?, Sort::<u32>::new(device, len)?);
    let buffer = Buffer::<u32>::new(device, "words", len)?;
    engine.upload(buffer.view(), &words(1, len))?;
    let mut recording = Recording::new(device);
    sort.record(&mut recording, len, buffer.view(), None, 32);
    scan.record(&mut recording, len, buffer.view(), buffer.view(), None);
    engine.run(&recording, &RunOptions { timestamps: true, ..RunOptions::default() })?;
    engine.download_vec(buffer.view())
}

/// Kernels that use f64 elsewhere, on a device that has none.
fn predicates_without_f64(device: &Device) {
    let arithmetic = Arithmetic::of(device).unwrap();
    assert_eq!(arithmetic, Arithmetic::Integers);
    let corners = [[0.1, 0.1], [0.3, 0.1], [0.1, 0.3], [0.3, 0.3], [9.0, 1e-9]].map(DVec2::from);
    let quadruples = [[0, 1, 2, 3], [1, 3, 0, 2], [0, 1, 2, 4]];
    let mut engine = Engine::new(device).unwrap();
    let positions = Buffer::<DVec2>::new(device, "positions", corners.len()).unwrap();
    let input = Buffer::<[u32; 4]>::new(device, "quadruples", quadruples.len()).unwrap();
    let output = Buffer::<u32>::new(device, "signs", quadruples.len()).unwrap();
    engine.upload(positions.view(), &corners).unwrap();
    engine.upload(input.view(), &quadruples).unwrap();
    let signs = Signs::new(device, arithmetic).unwrap();
    let mut recording = Recording::new(device);
    signs.record_must_flip(&mut recording, positions.view(), input.view(), output.view()).unwrap();
    engine.run(&recording, &RunOptions::default()).unwrap();
    let expected = polder_flip::reference::must_flip_signs(&corners, &quadruples).unwrap();
    assert_eq!(expected, [1, 0, 0]);
    assert_eq!(engine.download_vec(output.view().cast::<i32>()).unwrap(), expected);
}

/// Bytes that an allocator has given out.
fn given_out(allocator: &Mutex<Allocator>) -> u64 {
    allocator.lock().unwrap().generate_report().total_allocated_bytes
}

#[test]
fn everything_lent_is_used_and_nothing_of_it_destroyed() {
    let expected = work(&Gpu::open().device);
    let owner = Owner::new(false);
    let allocator = owner.allocator();
    for lent in [Some(&allocator), None, Some(&allocator)] {
        let device = owner.lend(lent.cloned(), &[], None);
        assert_eq!(device.self_test().unwrap(), SelfTest::NoFloat64);
        assert_eq!(work(&device), expected);
        predicates_without_f64(&device);
        // The owner's allocator holds what is held here, and no other does.
        let kept = Buffer::<u32>::new(&device, "kept", 1 << 20).unwrap();
        let held = given_out(&allocator);
        assert!(if lent.is_some() { held >= 4 << 20 } else { held == 0 }, "{held}");
        // The buffer keeps alive what it needs.
        drop(device);
        drop(kept);
        assert_eq!(given_out(&allocator), 0);
        owner.use_device();
    }
    assert_eq!(Arc::strong_count(&allocator), 1, "nobody holds the allocator any more");
    drop(allocator);
    assert_eq!(owner.end(), Vec::<String>::new());
}

/// Everything together: points and constraints in buffers on the lent device, and the result there.
#[test]
fn whole_triangulations_on_a_lent_device() {
    use polder::Options;

    let pslg = polder_io::generate::segments(400, 80, 3);
    let expected = polder::triangulate(&pslg, &Options::with_backend(polder::Backend::Cpu)).unwrap().triangulation;
    let owner = Owner::new(Gpu::open().device.has(Feature::ShaderFloat64));
    let allocator = owner.allocator();
    for named in [&[][..], &[Feature::ShaderFloat64]] {
        let device = owner.lend(Some(Arc::clone(&allocator)), named, None);
        let mut gpu = polder::Gpu::on(&device).unwrap();
        assert!(gpu.triangulate(&pslg, &Options::default()).unwrap().triangulation == expected);
        let points = Buffer::new(&device, "points", pslg.points().len()).unwrap();
        let constraints = Buffer::new(&device, "constraints", pslg.constraints().len()).unwrap();
        gpu.engine().upload(points.view(), pslg.points()).unwrap();
        gpu.engine().upload(constraints.view(), pslg.constraints()).unwrap();
        let all = (points.view(), constraints.view());
        let mut result = gpu.triangulate_constrained_on_device(all.0, all.1, &Options::default()).unwrap();
        assert_eq!(result.report().stages_on_cpu().count(), 0);
        assert!(result.fetch().unwrap() == expected);
        drop((gpu, points, constraints, device));
        assert_eq!(given_out(&allocator), 0);
        owner.use_device();
    }
    drop(allocator);
    assert_eq!(owner.end(), Vec::<String>::new());
}

#[test]
fn a_lent_device_may_fail_and_is_still_the_owners() {
    let expected = work(&Gpu::open().device);
    let owner = Owner::new(false);
    let allocator = owner.allocator();
    for fault in 0..3 {
        for index in 0..4 {
            let device = owner.lend(Some(Arc::clone(&allocator)), &[], Some(1 << 28));
            match fault {
                0 => device.faults().lose_at_submission(index),
                1 => device.faults().time_out_at_submission(index),
                _ => device.faults().refuse_allocation(index),
            }
            let done = work(&device);
            assert!(done.is_err() || done == expected);
            drop(device);
            assert_eq!(given_out(&allocator), 0);
            owner.use_device();
        }
    }
    assert_eq!(work(&owner.lend(Some(Arc::clone(&allocator)), &[], None)), expected);
    drop(allocator);
    assert_eq!(owner.end(), Vec::<String>::new());
}

#[test]
fn optional_features_are_used_if_they_are_named() {
    let float64 = Gpu::open().device.has(Feature::ShaderFloat64);
    let owner = Owner::new(float64);
    let device = owner.lend(None, &[Feature::ShaderFloat64], None);
    assert_eq!(device.has(Feature::ShaderFloat64), float64);
    assert_eq!(device.self_test().unwrap() != SelfTest::NoFloat64, float64);
    drop(device);
    let unnamed = owner.lend(None, &[], None);
    assert_eq!(unnamed.self_test().unwrap(), SelfTest::NoFloat64);
    drop(unnamed);
    assert_eq!(owner.end(), Vec::<String>::new());
}

/// That the layer, where there is one, would have found it: a buffer that outlives the device.
#[test]
fn what_is_left_behind_is_named() {
    let owner = Owner::new(false);
    // SAFETY: left behind on purpose.
    unsafe {
        let info = vk::BufferCreateInfo::default().size(64).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
        owner.device.create_buffer(&info, None).unwrap();
    }
    assert_eq!(owner.end().is_empty(), !options().validation);
}
