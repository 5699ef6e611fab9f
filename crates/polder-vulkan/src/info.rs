//! What devices there are, what they can do, and what is required of them.

use ash::vk;
use std::fmt;

/// A feature that a device must have, or that some kernels use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[expect(missing_docs, reason = "named as Vulkan names them")]
pub enum Feature {
    BufferDeviceAddress,
    ComputeFullSubgroups,
    HostQueryReset,
    ShaderFloat64,
    ShaderInt64,
    SubgroupSizeControl,
    Synchronization2,
    TimelineSemaphore,
}

impl Feature {
    /// Required of every device.
    pub const REQUIRED: &'static [Feature] = &[
        Feature::BufferDeviceAddress,
        Feature::ComputeFullSubgroups,
        Feature::HostQueryReset,
        Feature::ShaderInt64,
        Feature::SubgroupSizeControl,
        Feature::Synchronization2,
        Feature::TimelineSemaphore,
    ];
    /// Used where there.
    pub const OPTIONAL: &'static [Feature] = &[Feature::ShaderFloat64];

    /// The feature that a SPIR-V capability stands for, if it is one.
    pub(crate) fn of_capability(capability: &str) -> Option<Feature> {
        match capability {
            "Float64" => Some(Feature::ShaderFloat64),
            _ => None,
        }
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Feature::BufferDeviceAddress => "bufferDeviceAddress",
            Feature::ComputeFullSubgroups => "computeFullSubgroups",
            Feature::HostQueryReset => "hostQueryReset",
            Feature::ShaderFloat64 => "shaderFloat64",
            Feature::ShaderInt64 => "shaderInt64",
            Feature::SubgroupSizeControl => "subgroupSizeControl",
            Feature::Synchronization2 => "synchronization2",
            Feature::TimelineSemaphore => "timelineSemaphore",
        })
    }
}

/// What a caller who lends a device has to have asked for when making it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Requirements {
    /// Vulkan's version: major, minor.
    pub api_version: (u32, u32),
    /// Features that must be enabled.
    pub features: &'static [Feature],
    /// Features worth enabling where there.
    pub optional: &'static [Feature],
    /// Invocations of a workgroup.
    pub workgroup_invocations: u32,
    /// Bytes of shared memory of a workgroup.
    pub shared_bytes: u32,
    /// Subgroup operations in compute shaders.
    pub subgroup_operations: vk::SubgroupFeatureFlags,
}

/// What this crate requires of a device.
pub const fn requirements() -> Requirements {
    Requirements {
        api_version: (1, 3),
        features: Feature::REQUIRED,
        optional: Feature::OPTIONAL,
        workgroup_invocations: 256,
        shared_bytes: 16 * 1024,
        subgroup_operations: vk::SubgroupFeatureFlags::from_raw(
            vk::SubgroupFeatureFlags::BASIC.as_raw()
                | vk::SubgroupFeatureFlags::VOTE.as_raw()
                | vk::SubgroupFeatureFlags::ARITHMETIC.as_raw()
                | vk::SubgroupFeatureFlags::BALLOT.as_raw(),
        ),
    }
}

/// What a device is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceKind {
    /// A graphics card of its own.
    Discrete,
    /// Part of the processor.
    Integrated,
    /// In a virtual machine.
    Virtual,
    /// A CPU that plays a GPU, such as lavapipe: taken only when asked for.
    Cpu,
    /// Something else.
    Other,
}

/// Limits that kernels and buffers meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Invocations of a workgroup, made of subgroups of one size.
    pub workgroup_invocations: u32,
    /// Workgroups of a dispatch along each axis.
    pub workgroups: [u32; 3],
    /// Bytes of shared memory of a workgroup.
    pub shared_bytes: u32,
    /// Bytes of arguments.
    pub argument_bytes: u32,
    /// Bytes of one buffer.
    pub buffer_bytes: u64,
    /// Bytes of one allocation, as promised; some drivers give more (see [`Estimate::check`](crate::Estimate::check)).
    pub allocation_bytes: u64,
    /// Lanes of a subgroup, as kernels here get them.
    pub subgroup: u32,
}

/// A device and what it can do.
#[derive(Clone)]
pub struct DeviceInfo {
    /// Place in the driver's list: what `POLDER_DEVICE` takes.
    pub index: usize,
    /// The driver's name for it.
    pub name: String,
    /// What it is.
    pub kind: DeviceKind,
    /// Vulkan's version: major, minor, patch.
    pub api_version: (u32, u32, u32),
    /// The driver, in its words.
    pub driver: String,
    /// Bytes of device memory.
    pub memory_bytes: u64,
    /// Limits.
    pub limits: Limits,
    /// The features of [`Feature`] that it has.
    pub features: Vec<Feature>,
    /// What it lacks of [`requirements`]; empty when it can be used.
    pub missing: Vec<String>,
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) family: Option<u32>,
    pub(crate) timestamp_period: f32,
    pub(crate) timestamps: bool,
    pub(crate) portability_subset: bool,
    pub(crate) memory_budget: bool,
    pub(crate) cache_name: String,
}

impl fmt::Debug for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (major, minor, patch) = self.api_version;
        let limits = &self.limits;
        writeln!(f, "{}: {} ({:?}; {})", self.index, self.name, self.kind, self.driver)?;
        writeln!(f, "   Vulkan {major}.{minor}.{patch}, {} MiB of device memory", self.memory_bytes >> 20)?;
        writeln!(
            f,
            "   buffers up to {} MiB, workgroups of {}, {} KiB of shared memory, subgroups of {}",
            limits.buffer_bytes >> 20,
            limits.workgroup_invocations,
            limits.shared_bytes >> 10,
            limits.subgroup
        )?;
        let names: Vec<String> = self.features.iter().map(Feature::to_string).collect();
        write!(f, "   has {}", names.join(", "))?;
        if !self.missing.is_empty() {
            write!(f, "\n   cannot be used: it lacks {}", self.missing.join(", "))?;
        }
        Ok(())
    }
}

impl DeviceInfo {
    /// Whether the device has all of [`requirements`].
    pub fn usable(&self) -> bool {
        self.missing.is_empty()
    }

    pub(crate) fn of(instance: &ash::Instance, physical: vk::PhysicalDevice, index: usize) -> Self {
        let mut vulkan11 = vk::PhysicalDeviceVulkan11Properties::default();
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Properties::default();
        let mut vulkan13 = vk::PhysicalDeviceVulkan13Properties::default();
        // SAFETY: the physical device is of this instance; a 1.0 device answers this one.
        let plain = unsafe { instance.get_physical_device_properties(physical) };
        let version = plain.api_version;
        let api_version =
            (vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version));
        let modern = (api_version.0, api_version.1) >= requirements().api_version;
        if modern {
            let mut all = vk::PhysicalDeviceProperties2::default()
                .push_next(&mut vulkan11)
                .push_next(&mut vulkan12)
                .push_next(&mut vulkan13);
            // SAFETY: a device of version 1.3 knows all of these structures.
            unsafe { instance.get_physical_device_properties2(physical, &mut all) };
        }
        let features = if modern { features(instance, physical) } else { Vec::new() };
        // SAFETY: the physical device is of this instance.
        let memory = unsafe { instance.get_physical_device_memory_properties(physical) };
        let memory_bytes = memory.memory_heaps_as_slice().iter();
        let memory_bytes = memory_bytes.filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
        let memory_bytes = memory_bytes.map(|heap| heap.size).max().unwrap_or(0);
        // SAFETY: the physical device is of this instance.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        let family = families.iter().position(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE));
        // SAFETY: the physical device is of this instance.
        let extensions = unsafe { instance.enumerate_device_extension_properties(physical) }.unwrap_or_default();
        let has = |name: &std::ffi::CStr| extensions.iter().any(|found| found.extension_name_as_c_str() == Ok(name));
        let limits = Limits {
            workgroup_invocations: plain
                .limits
                .max_compute_work_group_invocations
                .min(plain.limits.max_compute_work_group_size[0])
                .min(vulkan11.subgroup_size.saturating_mul(vulkan13.max_compute_workgroup_subgroups)),
            workgroups: plain.limits.max_compute_work_group_count,
            shared_bytes: plain.limits.max_compute_shared_memory_size,
            argument_bytes: plain.limits.max_push_constants_size,
            buffer_bytes: vulkan13.max_buffer_size,
            allocation_bytes: vulkan11.max_memory_allocation_size,
            subgroup: vulkan11.subgroup_size,
        };
        let text = |found: Result<&std::ffi::CStr, _>| {
            found.map(|text: &std::ffi::CStr| text.to_string_lossy().into_owned()).unwrap_or_default()
        };
        let driver_name = text(vulkan12.driver_name_as_c_str().map_err(drop));
        let driver_info = text(vulkan12.driver_info_as_c_str().map_err(drop));
        let uuid: String = plain.pipeline_cache_uuid.iter().map(|byte| format!("{byte:02x}")).collect();
        let mut info = DeviceInfo {
            index,
            name: text(plain.device_name_as_c_str().map_err(drop)),
            kind: match plain.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
                vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
                vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
                vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
                _ => DeviceKind::Other,
            },
            api_version,
            driver: format!("{driver_name} {driver_info}").trim().to_owned(),
            memory_bytes,
            limits,
            features,
            missing: Vec::new(),
            physical,
            family: family.map(|family| family as u32),
            timestamp_period: plain.limits.timestamp_period,
            timestamps: family.is_some_and(|family| families[family].timestamp_valid_bits >= 36),
            portability_subset: has(c"VK_KHR_portability_subset"),
            memory_budget: has(ash::ext::memory_budget::NAME),
            cache_name: format!("{:x}-{:x}-{:x}-{uuid}", plain.vendor_id, plain.device_id, plain.driver_version),
        };
        let compute = vk::ShaderStageFlags::COMPUTE;
        info.missing = missing(&info, vulkan11.subgroup_supported_operations);
        if modern && !vulkan13.required_subgroup_size_stages.contains(compute) {
            info.missing.push("a required subgroup size in compute shaders".to_owned());
        }
        info
    }
}

fn features(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Vec<Feature> {
    let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut vulkan13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12).push_next(&mut vulkan13);
    // SAFETY: a device of version 1.3 knows all of these structures.
    unsafe { instance.get_physical_device_features2(physical, &mut all) };
    let plain = all.features;
    let has = [
        (Feature::BufferDeviceAddress, vulkan12.buffer_device_address),
        (Feature::ComputeFullSubgroups, vulkan13.compute_full_subgroups),
        (Feature::HostQueryReset, vulkan12.host_query_reset),
        (Feature::ShaderFloat64, plain.shader_float64),
        (Feature::ShaderInt64, plain.shader_int64),
        (Feature::SubgroupSizeControl, vulkan13.subgroup_size_control),
        (Feature::Synchronization2, vulkan13.synchronization2),
        (Feature::TimelineSemaphore, vulkan12.timeline_semaphore),
    ];
    has.into_iter().filter(|(_, has)| *has == vk::TRUE).map(|(feature, _)| feature).collect()
}

fn missing(info: &DeviceInfo, operations: vk::SubgroupFeatureFlags) -> Vec<String> {
    let wanted = requirements();
    let (major, minor) = wanted.api_version;
    if (info.api_version.0, info.api_version.1) < wanted.api_version {
        return vec![format!("Vulkan {major}.{minor} (it has {}.{})", info.api_version.0, info.api_version.1)];
    }
    let mut missing = Vec::new();
    for feature in wanted.features {
        if !info.features.contains(feature) {
            missing.push(feature.to_string());
        }
    }
    if !operations.contains(wanted.subgroup_operations) {
        missing.push(format!("subgroup operations {:?}", wanted.subgroup_operations & !operations));
    }
    if info.limits.workgroup_invocations < wanted.workgroup_invocations {
        missing.push(format!(
            "workgroups of {} (it has {})",
            wanted.workgroup_invocations, info.limits.workgroup_invocations
        ));
    }
    if info.limits.shared_bytes < wanted.shared_bytes {
        missing.push(format!("{} bytes of shared memory (it has {})", wanted.shared_bytes, info.limits.shared_bytes));
    }
    if info.family.is_none() {
        missing.push("a queue that computes".to_owned());
    }
    missing
}
