//! Fast pairs that are apart: where do they really touch within the step?
//!
//! The same kernels run at the pose of first touch, and the separations they find are carried back along the relative
//! motion to the start of the step. A pair that does not touch gets no point at all, so nothing is pushed by what it
//! never reaches; and of a mesh only the first obstacle on the path counts.
