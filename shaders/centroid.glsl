/* SPDX-License-Identifier: Zlib */
/* Multisampled, a stage runs once a pixel, for the pixel's centre, which may
 * lie outside of the triangle: what it then reads was extrapolated. HL_CENTROID
 * stages read at a place that the triangle covers, machine's choice; of pixels
 * that are covered whole, at the centre. HL_AT: such varyings. Derivatives by
 * quads of them are not slopes of anything at edges. */
#ifdef HL_CENTROID
#define HL_AT centroid
#else
#define HL_AT
#endif
