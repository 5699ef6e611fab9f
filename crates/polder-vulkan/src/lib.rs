//! The Vulkan compute engine of polder
