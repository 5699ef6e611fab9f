//! The CPU backend: divide and conquer, then constraints one by one
#![forbid(unsafe_code)]
