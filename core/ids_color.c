/* SPDX-License-Identifier: Zlib */
/* Greedy colouring in smallest-last order (Matula and Beck, "Smallest-last
 * ordering and clustering and graph coloring algorithms", 1983), the order
 * kept by a bucket queue in arrays (Batagelj and Zaversnik, "An O(m)
 * algorithm for cores decomposition of networks", 2003). */
#include <string.h>
#include "core/ids.h"
#include "core/mem.h"

#define NONE UINT32_MAX
#define MAX_COUNT 0x40000000u

struct graph {
    const struct hl_hooks *hooks;
    uint32_t n;
    uint32_t *first;         /* n + 1: where a node's neighbours begin       */
    uint32_t *to;            /* neighbours, each once                        */
    uint32_t *degree;        /* n: how many                                  */
    uint32_t *left;          /* n: degree among the nodes not yet ordered    */
    uint32_t *order;         /* n: nodes by `left`; ordered ones in front    */
    uint32_t *place;         /* n: where a node is in `order`                */
    uint32_t *bucket;        /* n: where nodes of a degree begin in `order`  */
    uint32_t *stamp;         /* n: node that last saw this node or colour    */
    uint32_t *tally;         /* n: its neighbours of this colour             */
};

static enum hl_result graph_open(struct graph *g, const struct hl_hooks *hooks,
                                 uint32_t n, uint32_t n_pairs)
{
    enum hl_result result = HL_OK;
    size_t each = sizeof(uint32_t);
    memset(g, 0, sizeof *g);
    g->hooks = hooks;
    g->n = n;
    g->first = hl_mem_new(hooks, (size_t)n + 1, each, &result);
    g->to = hl_mem_new(hooks, (size_t)n_pairs + 1, 2 * each, &result);
    g->degree = hl_mem_new(hooks, n, each, &result);
    g->left = hl_mem_new(hooks, n, each, &result);
    g->order = hl_mem_new(hooks, n, each, &result);
    g->place = hl_mem_new(hooks, n, each, &result);
    g->bucket = hl_mem_new(hooks, n, each, &result);
    g->stamp = hl_mem_new(hooks, n, each, &result);
    g->tally = hl_mem_new(hooks, n, each, &result);
    return result;
}

static void graph_close(struct graph *g)
{
    hl_mem_free(g->hooks, g->first);
    hl_mem_free(g->hooks, g->to);
    hl_mem_free(g->hooks, g->degree);
    hl_mem_free(g->hooks, g->left);
    hl_mem_free(g->hooks, g->order);
    hl_mem_free(g->hooks, g->place);
    hl_mem_free(g->hooks, g->bucket);
    hl_mem_free(g->hooks, g->stamp);
    hl_mem_free(g->hooks, g->tally);
}

/* Each pair goes into the lists of both ends. */
static void fill_lists(struct graph *g, const uint32_t *pairs, size_t n_ends)
{
    memset(g->first, 0, (g->n + (size_t)1) * sizeof *g->first);
    for (size_t i = 0; i < n_ends; i++)
        g->first[pairs[i] + 1]++;
    for (uint32_t v = 0; v < g->n; v++) {
        g->first[v + 1] += g->first[v];
        g->degree[v] = 0;
    }
    for (size_t i = 0; i < n_ends; i++) {
        uint32_t v = pairs[i];
        g->to[g->first[v] + g->degree[v]++] = pairs[i ^ 1];
    }
}

/* Doubles would count in a degree and spoil the order's guarantee. */
static void drop_doubles(struct graph *g)
{
    for (uint32_t v = 0; v < g->n; v++)
        g->stamp[v] = NONE;
    for (uint32_t v = 0; v < g->n; v++) {
        uint32_t *to = &g->to[g->first[v]], kept = 0;
        g->stamp[v] = v;
        for (uint32_t i = 0; i < g->degree[v]; i++) {
            if (g->stamp[to[i]] == v)
                continue;
            g->stamp[to[i]] = v;
            to[kept++] = to[i];
        }
        g->degree[v] = kept;
    }
}

/* Counting sort of the nodes by degree. */
static void sort_by_degree(struct graph *g)
{
    uint32_t start = 0;
    memset(g->bucket, 0, g->n * sizeof *g->bucket);
    for (uint32_t v = 0; v < g->n; v++)
        g->bucket[g->degree[v]]++;
    for (uint32_t d = 0; d < g->n; d++) {
        uint32_t n = g->bucket[d];
        g->bucket[d] = start;
        start += n;
    }
    for (uint32_t v = 0; v < g->n; v++) {
        g->left[v] = g->degree[v];
        g->place[v] = g->bucket[g->left[v]]++;
        g->order[g->place[v]] = v;
    }
    for (uint32_t d = g->n; d-- > 1;)
        g->bucket[d] = g->bucket[d - 1];
    g->bucket[0] = 0;
}

/* Swaps v with the first node of its bucket, then moves the bucket's start
 * past it: v now ends the bucket of one degree less. */
static void lower(struct graph *g, uint32_t v)
{
    uint32_t start = g->bucket[g->left[v]], other = g->order[start];
    g->order[g->place[v]] = other;
    g->place[other] = g->place[v];
    g->order[start] = v;
    g->place[v] = start;
    g->bucket[g->left[v]]++;
    g->left[v]--;
}

/* A node's `left` stops falling at that of the node now taken, so that no
 * bucket is passed twice; it still bounds the true degree from above. */
static void order_nodes(struct graph *g)
{
    sort_by_degree(g);
    for (uint32_t i = 0; i < g->n; i++) {
        uint32_t v = g->order[i];
        const uint32_t *to = &g->to[g->first[v]];
        for (uint32_t k = 0; k < g->degree[v]; k++)
            if (g->left[to[k]] > g->left[v])
                lower(g, to[k]);
    }
}

/* The lowest colour that no coloured neighbour has, or below max the one
 * that the fewest have. At most `degree` colours are looked at before a free
 * one turns up, and max only when there are that many neighbours. */
static uint32_t pick_color(struct graph *g, const uint32_t *color, uint32_t v,
                           uint32_t max)
{
    const uint32_t *to = &g->to[g->first[v]];
    uint32_t best = 0;
    for (uint32_t k = 0; k < g->degree[v]; k++) {
        uint32_t c = color[to[k]];
        if (c == NONE)
            continue;
        g->tally[c] = g->stamp[c] == v ? g->tally[c] + 1 : 1;
        g->stamp[c] = v;
    }
    for (uint32_t c = 0; c < max; c++) {
        if (g->stamp[c] != v)
            return c;
        if (g->tally[c] < g->tally[best])
            best = c;
    }
    return best;
}

static void color_nodes(struct graph *g, uint32_t max, uint32_t *color,
                        struct hl_ids_coloring *out)
{
    for (uint32_t v = 0; v < g->n; v++)
        color[v] = g->stamp[v] = NONE;
    for (uint32_t i = g->n; i-- > 0;) {
        uint32_t v = g->order[i];
        color[v] = pick_color(g, color, v, max);
        if (color[v] >= out->n_colors)
            out->n_colors = color[v] + 1;
    }
    for (uint32_t v = 0; v < g->n; v++)
        for (uint32_t k = 0; k < g->degree[v]; k++) {
            uint32_t u = g->to[g->first[v] + k];
            out->n_conflicts += u < v && color[u] == color[v];
        }
}

static enum hl_result check(const struct hl_hooks *hooks, uint32_t n_nodes,
                            const uint32_t *pairs, uint32_t n_pairs,
                            const uint32_t *color)
{
    if (!hl_mem_hooks_valid(hooks) || (n_nodes > 0 && !color) ||
        (n_pairs > 0 && !pairs))
        return HL_ERR_INVALID;
    if (n_nodes > MAX_COUNT || n_pairs > MAX_COUNT)
        return HL_ERR_LIMIT;
    for (size_t i = 0; i < 2 * (size_t)n_pairs; i++)
        if (pairs[i] >= n_nodes)
            return HL_ERR_INVALID;
    return HL_OK;
}

enum hl_result hl_ids_color(const struct hl_hooks *hooks, uint32_t n_nodes,
                            const uint32_t *pairs, uint32_t n_pairs,
                            uint32_t max_colors, uint32_t *color,
                            struct hl_ids_coloring *out)
{
    struct graph g;
    enum hl_result result = HL_ERR_INVALID;
    if (out)
        result = check(hooks, n_nodes, pairs, n_pairs, color);
    if (result != HL_OK)
        return result;
    if (n_nodes == 0) {
        memset(out, 0, sizeof *out);
        return HL_OK;
    }
    result = graph_open(&g, hooks, n_nodes, n_pairs);
    if (result == HL_OK) {
        memset(out, 0, sizeof *out);
        fill_lists(&g, pairs, 2 * (size_t)n_pairs);
        drop_doubles(&g);
        order_nodes(&g);
        color_nodes(&g, max_colors ? max_colors : NONE, color, out);
    }
    graph_close(&g);
    return result;
}
