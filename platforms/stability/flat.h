/* SPDX-License-Identifier: Zlib */
#ifndef HLS_FLAT_H
#define HLS_FLAT_H
/* Scenes of flat pieces that face the camera, placed by frame pixels: what a
 * sweep of widths, angles and offsets is drawn with. One directional light
 * along the view of colour 1 lights them, so that a piece's light is the view
 * component of its normal, which is chosen freely, and is constant over it.
 * Pixels run right and down from the picture's top left corner. */
#include "platforms/host/builder.h"
#include "platforms/stability/stability.h"

struct hls_flat {
    struct hlh_scene scene;
    struct hlh_builder b;
    uint32_t width, height;
};

void hls_flat_begin(struct hls_flat *, uint32_t width, uint32_t height);
/* Add a parallelogram: middle, and half sides a and b, pixels; `back` frame
 * heights behind the plane that is one height away; its light 0..1. */
void hls_flat_piece(struct hls_flat *, const double middle[2],
                    const double a[2], const double b[2], double back,
                    double light);
/* Close the pieces added since as one object of this colour and opacity. */
void hls_flat_object(struct hls_flat *, double grey, double alpha);
/* A directional light of another colour in place of the one of 1. */
void hls_flat_light(struct hls_flat *, double color);
/* Hand the scene to the lab. False with a line printed. */
bool hls_flat_end(struct hls_flat *, struct hls_lab *,
                  const struct hlc_options *o);

/* The lab's options for a picture of this size by inferred lighting of
 * `eighths` / 8 of it a side, without specular light. */
struct hlc_options hls_flat_options(const struct hls_lab *, uint32_t width,
                                    uint32_t height, uint32_t eighths);

/* Draw the lab's scene once by the options; *out by hlh_picture_free. False
 * with a line printed. */
bool hls_flat_draw(struct hlh_picture *out, struct hls_lab *,
                   const struct hlc_options *o);
/* The same for a picture of the inside, malloc'd. */
bool hls_flat_inspect(void **out, enum hl_inspect, struct hls_lab *,
                      const struct hlc_options *o);
/* Print a line and note it; false. */
bool hls_broken(struct hls_lab *, const char *line);
#endif
