//! Kernels: shaders made ready for one device.

use crate::Error;
use crate::device::{Device, DeviceInner};
use crate::error::Called;
use crate::info::Feature;
use crate::shader::{Code, Shader, Side};
use ash::vk;
use rayon::prelude::*;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

pub(crate) struct KernelInner {
    pub(crate) name: &'static str,
    compiled: Arc<Compiled>,
    pub(crate) device: Arc<DeviceInner>,
}

/// What a driver made of a shader. It belongs to its device, and goes with it.
#[derive(Clone, Copy)]
pub(crate) struct Pipeline {
    pub(crate) raw: vk::Pipeline,
    pub(crate) layout: vk::PipelineLayout,
}

/// A shader with its constants, compiled or to be compiled.
struct Compiled {
    code: Code,
    values: Vec<u32>,
    pipeline: OnceLock<Pipeline>,
    /// Held by who compiles it.
    compiling: Mutex<()>,
}

impl Compiled {
    /// Compiles it, if nobody did; not for good if that fails, as memory may be free again later.
    fn get(&self, device: &DeviceInner) -> Result<Pipeline, Error> {
        if let Some(known) = self.pipeline.get() {
            return Ok(*known);
        }
        let _one = self.compiling.lock().unwrap_or_else(PoisonError::into_inner);
        match self.pipeline.get() {
            Some(known) => Ok(*known),
            None => {
                device.alive()?;
                let made = build(device, &self.code, &self.values)?;
                Ok(*self.pipeline.get_or_init(|| made))
            }
        }
    }
}

impl KernelInner {
    pub(crate) fn pipeline(&self) -> Result<Pipeline, Error> {
        self.compiled.get(&self.device)
    }
}

type Known = HashMap<(usize, Vec<u32>), Arc<Compiled>>;

/// All kernels that were asked for on a device, by code and constants.
#[derive(Default)]
pub(crate) struct Pipelines {
    known: Mutex<Known>,
    /// Those that may have to be compiled.
    waiting: Mutex<Vec<Arc<Compiled>>>,
}

impl Pipelines {
    fn get(&self, code: &Code, values: Vec<u32>) -> Arc<Compiled> {
        // Code is static, so its place tells it from all other code.
        let key = (code.words.as_ptr() as usize, values.clone());
        let new = || {
            let new = Compiled { code: *code, values, pipeline: OnceLock::new(), compiling: Mutex::default() };
            let new = Arc::new(new);
            self.waiting().push(Arc::clone(&new));
            new
        };
        Arc::clone(self.known().entry(key).or_insert_with(new))
    }

    /// Compiles what waits for it, by all threads of rayon's pool, the longest first.
    pub(crate) fn compile(&self, device: &DeviceInner) -> Result<(), Error> {
        let mut waiting = std::mem::take(&mut *self.waiting());
        waiting.sort_unstable_by_key(|kernel| std::cmp::Reverse(kernel.code.words.len()));
        waiting.par_iter().with_max_len(1).try_for_each(|kernel| kernel.get(device).map(|_| ()))
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn waiting(&self) -> MutexGuard<'_, Vec<Arc<Compiled>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn count(&self) -> usize {
        self.known().len()
    }

    /// Once nothing is left that was made from the device.
    pub(crate) fn destroy(&mut self, raw: &ash::Device) {
        let known = self.known.get_mut().unwrap_or_else(PoisonError::into_inner);
        for Pipeline { raw: pipeline, layout } in known.drain().filter_map(|(_, kernel)| kernel.pipeline.get().copied())
        {
            // SAFETY: of this device; kernels keep their device, and recordings and engines what is in flight, so it is
            // in no use, and all that could use it is gone.
            unsafe {
                raw.destroy_pipeline(pipeline, None);
                raw.destroy_pipeline_layout(layout, None);
            }
        }
    }
}

/// A shader, compiled for a device: by [`Device::compile`], or else before it first runs.
pub struct Kernel<S> {
    pub(crate) inner: Arc<KernelInner>,
    workgroup: [u32; 3],
    of: PhantomData<fn() -> S>,
}

impl<S> Clone for Kernel<S> {
    fn clone(&self) -> Self {
        Kernel { inner: Arc::clone(&self.inner), workgroup: self.workgroup, of: PhantomData }
    }
}

impl<S> std::fmt::Debug for Kernel<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Kernel({}, workgroup {:?})", self.inner.name, self.workgroup)
    }
}

impl<S: Shader> Kernel<S> {
    /// Compiled once a device: the same shader with the same constants is the same kernel. `constants` sets
    /// specialization constants by name; the others keep their defaults. Fails where the device lacks a feature or the
    /// workgroup passes its limits. A device without f64 gets the shader's code without f64, if there is any.
    pub fn new(device: &Device, constants: &[(&'static str, u32)]) -> Result<Self, Error> {
        if device.has(Feature::ShaderFloat64) {
            Self::of_code(device, &S::CODE, constants)
        } else {
            Self::without_float64(device, constants)
        }
    }

    /// The same, from the code without f64 on any device, if there is any.
    pub fn without_float64(device: &Device, constants: &[(&'static str, u32)]) -> Result<Self, Error> {
        Self::of_code(device, &S::CODE.less_float64(), constants)
    }

    fn of_code(device: &Device, code: &Code, constants: &[(&'static str, u32)]) -> Result<Self, Error> {
        let values = specialize(code, constants)?;
        let workgroup = code.workgroup.map(|side| match side {
            Side::Fixed(count) => count,
            Side::Constant(id) => {
                let place = code.constants.iter().position(|constant| constant.id == id);
                place.map_or(1, |place| values[place])
            }
        });
        check(device, code, workgroup)?;
        device.inner.alive()?;
        let compiled = device.inner.pipelines.get(code, values);
        let inner = KernelInner { name: code.name, compiled, device: Arc::clone(&device.inner) };
        Ok(Kernel { inner: Arc::new(inner), workgroup, of: PhantomData })
    }

    /// Invocations of a workgroup along each axis.
    pub fn workgroup(&self) -> [u32; 3] {
        self.workgroup
    }
}

fn specialize(code: &Code, set: &[(&'static str, u32)]) -> Result<Vec<u32>, Error> {
    let mut values: Vec<u32> = code.constants.iter().map(|constant| constant.default).collect();
    for (name, value) in set {
        let place = code.constants.iter().position(|constant| constant.name == *name);
        let place = place.ok_or_else(|| refused(code, format!("it has no constant {name}")))?;
        values[place] = *value;
    }
    Ok(values)
}

fn refused(code: &Code, why: String) -> Error {
    Error::Recording { command: code.name, why }
}

fn check(device: &Device, code: &Code, workgroup: [u32; 3]) -> Result<(), Error> {
    let info = device.info();
    for feature in code.capabilities.iter().filter_map(|capability| Feature::of_capability(capability)) {
        let done_without = feature == Feature::ShaderFloat64 && code.is_less_float64();
        if !done_without && !device.has(feature) {
            let missing = format!("{feature}, which kernel `{}` needs", code.name);
            return Err(Error::Unsupported { device: info.name.clone(), missing });
        }
    }
    let invocations = workgroup.iter().fold(1_u64, |product, side| product.saturating_mul(u64::from(*side)));
    let most = info.limits.workgroup_invocations;
    if invocations == 0 || invocations > u64::from(most) {
        return Err(refused(code, format!("a workgroup of {invocations}; the device has up to {most}")));
    }
    if !workgroup[0].is_multiple_of(info.limits.subgroup) && code.capabilities.contains(&"GroupNonUniform") {
        let lanes = info.limits.subgroup;
        return Err(refused(code, format!("a workgroup of {} is not made of subgroups of {lanes}", workgroup[0])));
    }
    Ok(())
}

fn build(device: &DeviceInner, code: &Code, values: &[u32]) -> Result<Pipeline, Error> {
    let (words, _) = code.words.as_chunks::<4>();
    let words: Vec<u32> = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let module = vk::ShaderModuleCreateInfo::default().code(&words);
    // SAFETY: the device is alive; the words are a valid module, as `cargo xtask shaders` checks.
    let module = unsafe { device.raw.create_shader_module(&module, None) }.called("vkCreateShaderModule")?;
    let made = with_module(device, code, values, module);
    // SAFETY: the module is needed only while the pipeline is made.
    unsafe { device.raw.destroy_shader_module(module, None) };
    device.note(made)
}

fn with_module(device: &DeviceInner, code: &Code, values: &[u32], module: vk::ShaderModule) -> Result<Pipeline, Error> {
    let ranges =
        [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(code.argument_bytes)];
    let layout = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges);
    // SAFETY: the device is alive, the range within the 128 bytes that every device has.
    let layout = unsafe { device.raw.create_pipeline_layout(&layout, None) }.called("vkCreatePipelineLayout")?;
    let entries: Vec<vk::SpecializationMapEntry> = code
        .constants
        .iter()
        .enumerate()
        .map(|(place, constant)| {
            vk::SpecializationMapEntry::default().constant_id(constant.id).offset(4 * place as u32).size(4)
        })
        .collect();
    let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(values));
    // One size of subgroup, and all of them full: kernels number their invocations by subgroup.
    let mut subgroup = vk::PipelineShaderStageRequiredSubgroupSizeCreateInfo::default()
        .required_subgroup_size(device.info.limits.subgroup);
    let mut stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(module)
        .name(c"main")
        .specialization_info(&specialization);
    if code.capabilities.contains(&"GroupNonUniform") {
        stage = stage.flags(vk::PipelineShaderStageCreateFlags::REQUIRE_FULL_SUBGROUPS).push_next(&mut subgroup);
    }
    let description = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
    // SAFETY: module, layout and cache are of this device and alive.
    let made = unsafe { device.raw.create_compute_pipelines(device.cache.raw, &[description], None) };
    match made {
        Ok(pipelines) => Ok(Pipeline { raw: pipelines[0], layout }),
        Err((_, result)) => {
            // SAFETY: nothing was made with it.
            unsafe { device.raw.destroy_pipeline_layout(layout, None) };
            Err(result).called("vkCreateComputePipelines")
        }
    }
}
