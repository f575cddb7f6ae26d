/* SPDX-License-Identifier: Zlib */
/* Pictures without a library: PFM files. */
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

bool hlh_picture_write_pfm(const struct hlh_picture *p, const char *path,
                           struct hlh_error *error)
{
    struct hlh_buffer out = {0};
    bool ok;
    hlh_buffer_print(&out, "PF\n%u %u\n-1.0\n", (unsigned)p->width,
                     (unsigned)p->height);
    for (uint32_t y = p->height; y-- > 0 && !out.failed;)
        for (uint32_t x = 0; x < p->width * 3; x++) {
            uint32_t u;
            uint8_t b[4];
            memcpy(&u, &p->rgb[(size_t)y * p->width * 3 + x], sizeof u);
            for (int k = 0; k < 4; k++)
                b[k] = (uint8_t)(u >> (8 * k));
            hlh_buffer_add(&out, b, 4);
        }
    if (out.failed)
        ok = hlh_fail(error, path, "out of memory");
    else
        ok = hlh_file_write(path, out.bytes, out.size, error);
    hlh_buffer_free(&out);
    return ok;
}

void hlh_picture_free(struct hlh_picture *p)
{
    free(p->rgb);
    memset(p, 0, sizeof *p);
}
