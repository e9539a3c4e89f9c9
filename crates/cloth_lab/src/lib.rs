//! cloth_lab
