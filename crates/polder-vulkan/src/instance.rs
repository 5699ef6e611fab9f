//! The loader, the instance, and what the validation layer says.

use crate::Error;
use crate::Selection;
use crate::error::Called;
use crate::info::DeviceInfo;
use ash::{ext, vk};
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What the validation layer has said, oldest first.
type Messages = Mutex<Vec<String>>;

pub(crate) struct InstanceInner {
    pub(crate) raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Box<Messages>,
    owned: bool,
    /// The loaded library; it must outlive all that was loaded from it.
    _entry: Option<ash::Entry>,
}

/// Held while instances and devices are made, listed and destroyed. The specification lets threads do that side by side;
/// an NVIDIA driver (580) now and then never came back from it. What it guards is the instance that everybody shares.
pub(crate) fn one_at_a_time() -> MutexGuard<'static, Option<Instance>> {
    static SHARED: Mutex<Option<Instance>> = Mutex::new(None);
    SHARED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Vulkan on this machine, loaded at run time.
#[derive(Clone)]
pub struct Instance {
    pub(crate) inner: Arc<InstanceInner>,
}

const VALIDATION: &CStr = c"VK_LAYER_KHRONOS_validation";

impl Instance {
    /// Loads Vulkan; from then on it stays loaded until the process ends, and all calls give the same instance. With
    /// `validation` they give one of their own: the Khronos layer watches its every call, and [`Instance::messages`]
    /// tells what it said.
    pub fn load(validation: bool) -> Result<Self, Error> {
        // The last instance to go would unload the driver, under threads that ran its code and have yet to end: NVIDIA's
        // (580) has something to do then, and the process crashes.
        let mut shared = one_at_a_time();
        let instance = match &*shared {
            Some(instance) => instance.clone(),
            None => shared.insert(Instance::new(false)?).clone(),
        };
        if validation { Instance::new(true) } else { Ok(instance) }
    }

    fn new(validation: bool) -> Result<Self, Error> {
        // SAFETY: the library found is the system's Vulkan loader; loading it runs its initializers, which any Vulkan
        // program trusts.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| Error::NoVulkan(error.to_string()))?;
        let application = vk::ApplicationInfo::default().application_name(c"polder").api_version(vk::API_VERSION_1_3);
        let mut layers = Vec::new();
        let mut extensions = Vec::new();
        let mut flags = vk::InstanceCreateFlags::empty();
        // SAFETY: the entry is loaded.
        let known = unsafe { entry.enumerate_instance_extension_properties(None) }
            .called("vkEnumerateInstanceExtensionProperties")?;
        let has = |name: &CStr| known.iter().any(|found| found.extension_name_as_c_str() == Ok(name));
        if has(ash::khr::portability_enumeration::NAME) {
            extensions.push(ash::khr::portability_enumeration::NAME.as_ptr());
            flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }
        let messages = Box::new(Messages::default());
        if validation {
            // SAFETY: the entry is loaded.
            let known =
                unsafe { entry.enumerate_instance_layer_properties() }.called("vkEnumerateInstanceLayerProperties")?;
            if !known.iter().any(|found| found.layer_name_as_c_str() == Ok(VALIDATION)) {
                return Err(Error::NoValidation);
            }
            layers.push(VALIDATION.as_ptr());
            extensions.push(ext::debug_utils::NAME.as_ptr());
        }
        let mut messenger = messenger_info(&messages);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions)
            .flags(flags);
        if validation {
            info = info.push_next(&mut messenger);
        }
        // SAFETY: all that the description points to lives until the call returns; the messages live in a box that the
        // instance keeps.
        let raw = unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
            vk::Result::ERROR_INCOMPATIBLE_DRIVER => Error::NoVulkan("no driver is installed".to_owned()),
            result => Error::Vulkan { call: "vkCreateInstance", result },
        })?;
        let mut watcher = None;
        if validation {
            let loaded = ext::debug_utils::Instance::new(&entry, &raw);
            // SAFETY: the extension is enabled, and the messages outlive the messenger (see `drop`).
            let made = unsafe { loaded.create_debug_utils_messenger(&messenger_info(&messages), None) }
                .called("vkCreateDebugUtilsMessengerEXT")
                // SAFETY: nothing else was made from the instance.
                .inspect_err(|_| unsafe { raw.destroy_instance(None) })?;
            watcher = Some((loaded, made));
        }
        let inner = InstanceInner { raw, messenger: watcher, messages, owned: true, _entry: Some(entry) };
        Ok(Instance { inner: Arc::new(inner) })
    }

    /// An instance that somebody else owns and destroys.
    pub(crate) fn borrowed(raw: ash::Instance) -> Self {
        let inner = InstanceInner { raw, messenger: None, messages: Box::default(), owned: false, _entry: None };
        Instance { inner: Arc::new(inner) }
    }

    /// Every device, in the driver's order, usable or not.
    pub fn devices(&self) -> Result<Vec<DeviceInfo>, Error> {
        let _alone = one_at_a_time();
        // SAFETY: the instance is alive.
        let found = unsafe { self.inner.raw.enumerate_physical_devices() }.called("vkEnumeratePhysicalDevices")?;
        Ok(found
            .into_iter()
            .enumerate()
            .map(|(index, physical)| DeviceInfo::of(&self.inner.raw, physical, index))
            .collect())
    }

    /// The device that a selection takes, as [`Device::open_on`](crate::Device::open_on) does.
    pub fn device(&self, selection: &Selection) -> Result<DeviceInfo, Error> {
        Ok(selection.pick(&self.devices()?)?.clone())
    }

    /// What the validation layer has said since the instance was made.
    pub fn messages(&self) -> Vec<String> {
        self.inner.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl std::fmt::Debug for Instance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Instance").field("owned", &self.inner.owned).finish_non_exhaustive()
    }
}

impl Drop for InstanceInner {
    fn drop(&mut self) {
        let _alone = one_at_a_time();
        if let Some((loaded, messenger)) = self.messenger.take() {
            // SAFETY: made from this instance, and destroyed only here.
            unsafe { loaded.destroy_debug_utils_messenger(messenger, None) };
        }
        if self.owned {
            // SAFETY: every device keeps its instance alive, so none is left; this is the only place that destroys it.
            unsafe { self.raw.destroy_instance(None) };
        }
    }
}

fn messenger_info(messages: &Messages) -> vk::DebugUtilsMessengerCreateInfoEXT<'_> {
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
        .message_type(
            vk::DebugUtilsMessageTypeFlagsEXT::GENERAL
                | vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
        )
        .pfn_user_callback(Some(keep_message))
        .user_data(std::ptr::from_ref(messages).cast_mut().cast())
}

unsafe extern "system" fn keep_message(
    _: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: `user` is the box of messages that the instance keeps until the messenger is gone; `data` and its text are
    // the layer's, valid during this call.
    let (messages, text) = unsafe {
        let text = (*data).message_as_c_str();
        (&*user.cast::<Messages>(), text.map(|text| text.to_string_lossy().into_owned()))
    };
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text.unwrap_or_default());
    vk::FALSE
}
