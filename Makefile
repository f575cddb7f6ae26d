# halflight. make              the tool and the libraries, in build/$(config)
#            make run          install what is missing, build, draw, report
#            make test         install what is missing, build, run all suites
#            make check        include arrows, undefined symbols, headers alone
#            make packemu      the software device and a program that draws with
#                              it: a C99 compiler, libc, libm and threads alone
#            make docs         measured tables of docs/*.md made anew
#            make fuzz         FUZZ_SECONDS of random plans and passes (clang and
#                              its libFuzzer, Debian's libclang-rt-14-dev)
# config=debug|release|sanitize|coverage
config ?= release
ifeq ($(origin CC),default)
CC := gcc
endif
# CC="gcc -std=c99", CC=clang, CC=powerpc64-linux-gnu-gcc: objects of another
# compiler have a folder of their own, a cross compiler brings its archiver.
CC_NAME := $(notdir $(firstword $(CC)))
CROSS := $(patsubst %gcc,%,$(filter %-gcc,$(firstword $(CC))))
ifeq ($(origin AR),default)
AR := $(CROSS)ar
endif
B := build/$(config)$(if $(filter-out gcc,$(CC_NAME)),-$(CC_NAME))
GEN := build/gen
# V=1 prints commands whole.
Q := $(if $(V),,@)
JOBS := -j$(shell nproc 2>/dev/null || echo 1)

# -ffp-contract=off: a*b+c is two roundings everywhere, so that core's numbers
# are the same on every compiler; errno and traps are never read.
STD := -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror
CFLAGS_release := -O3 -fno-math-errno -fno-trapping-math
CFLAGS_debug := -O0 -g
CFLAGS_sanitize := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
CFLAGS_coverage := -O0 -g --coverage
LDFLAGS_sanitize := -fsanitize=address,undefined
LDFLAGS_coverage := --coverage
ALL_CFLAGS = $(STD) -ffp-contract=off $(CFLAGS_$(config)) -I. -I$(GEN) $(CFLAGS)
ALL_LDFLAGS = $(LDFLAGS_$(config)) $(LDFLAGS)
# The tool and the tests read files, clocks and threads: POSIX, not core.
HOST_CFLAGS := -D_POSIX_C_SOURCE=200809L -pthread
HOST_LIBS := -lassimp -lcjson -lpng -ljpeg -pthread -lm
VULKAN_LIBS := -lvulkan
# GL and EGL are found at run time.
GL_LIBS := -ldl

lib = $(B)/lib$(1).a
objs = $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(1)))

HAL := $(call objs,hal/*.c) $(call objs,core/*.c)
NULLB := $(call objs,platforms/null/*.c)
VULKAN := $(call objs,platforms/vulkan/*.c) $(B)/obj/gen/hl_spirv.o
GL := $(call objs,platforms/gl/*.c) $(B)/obj/gen/hl_glsl.o
PACKEMU := $(call objs,platforms/packemu/*.c)
PROFILES := $(call objs,platforms/profiles/*.c)
CONFORM := $(call objs,platforms/conform/*.c)
HOST := $(call objs,platforms/host/*.c)
REFERENCE := $(call objs,platforms/reference/*.c)
CLI_LIB := $(filter-out %/main.o %/packemu_main.o,$(call objs,platforms/cli/*.c))
# What of host and cli needs no library: built-in scenes drawn by a device.
PLAIN := $(patsubst %,$(B)/obj/platforms/host/%.o,builder builtin builtin_brdf builtin_cutout builtin_hall builtin_layers \
    builtin_paper builtin_shadow builtin_stress builtin_works file image_pfm mesh_clean scene_finish shapes util) \
  $(patsubst %,$(B)/obj/platforms/cli/%.o,bridge bridge_ids bridge_mesh bridge_shadow bridge_texture fail plan_reason \
    plan_text readback render_device setup shot spread tap value view)
CHART := $(call objs,platforms/chart/*.c) $(call objs,platforms/stability/*.c) $(call objs,platforms/calibrate/*.c)
LIST := $(B)/obj/platforms/platforms.o

LIBS := $(foreach x,halflight halflight-null halflight-packemu halflight-profiles halflight-conform halflight-vulkan \
    halflight-gl,$(call lib,$(x)))
TOOL_LIBS := $(foreach x,chart cli host reference list conform vulkan gl packemu profiles null,$(call lib,halflight-$(x))) \
  $(call lib,halflight)
PACKEMU_LIBS := $(call lib,halflight-conform) $(call lib,halflight-packemu) $(call lib,halflight-profiles) $(call lib,halflight)

.PHONY: all libs tool packemu plain-tests run test tests check deps clean bench fuzz fuzzers docs
all: tool libs
libs: $(LIBS)
tool: $(B)/halflight
packemu: $(B)/halflight-packemu

$(call lib,halflight): $(HAL)
$(call lib,halflight-null): $(NULLB)
$(call lib,halflight-vulkan): $(VULKAN)
$(call lib,halflight-gl): $(GL)
$(call lib,halflight-packemu): $(PACKEMU)
$(call lib,halflight-profiles): $(PROFILES)
$(call lib,halflight-conform): $(CONFORM)
$(call lib,halflight-host): $(HOST)
$(call lib,halflight-reference): $(REFERENCE)
$(call lib,halflight-cli): $(CLI_LIB)
$(call lib,halflight-list): $(LIST)
# Sweeps over the tool's own parts: chart, stability, calibrate.
$(call lib,halflight-chart): $(CHART)
%.a:
	@mkdir -p $(@D); rm -f $@
	@echo "  AR   $@"
	$(Q)$(AR) rcs $@ $^

$(B)/halflight: $(B)/obj/platforms/cli/main.o $(TOOL_LIBS)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(VULKAN_LIBS) $(GL_LIBS) $(HOST_LIBS)

$(B)/halflight-packemu: $(B)/obj/platforms/cli/packemu_main.o $(PLAIN) $(PACKEMU_LIBS)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ -pthread -lm

$(B)/obj/platforms/packemu/%.o $(B)/obj/platforms/host/%.o $(B)/obj/platforms/cli/%.o $(B)/obj/platforms/chart/%.o $(B)/obj/platforms/stability/%.o \
  $(B)/obj/platforms/calibrate/%.o $(B)/obj/platforms/reference/%.o $(B)/obj/tests/%.o: EXTRA := $(HOST_CFLAGS)
$(B)/obj/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	$(Q)$(CC) $(ALL_CFLAGS) $(EXTRA) -MMD -MP -c -o $@ $<
$(B)/obj/gen/%.o: $(GEN)/%.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	$(Q)$(CC) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

# Shaders: one SPIR-V blob, and one GLSL text for GL, a row of
# shaders/variants.def, embedded as C.
$(GEN)/hl_spirv.c $(GEN)/hl_glsl.c: $(GEN)/hl_%.c: shaders/embed.sh shaders/variants.def $(wildcard shaders/*.vert shaders/*.frag shaders/*.glsl shaders/shared/*.h)
	@mkdir -p $(GEN)
	@echo "  GLSL $@"
	$(Q)sh shaders/embed.sh $* $@
$(VULKAN): | $(GEN)/hl_spirv.c
$(GL): | $(GEN)/hl_glsl.c

# Tests: every tests/test_*.c is a cmocka program over all libraries.
TESTS := $(patsubst tests/%.c,$(B)/tests/%,$(wildcard tests/test_*.c)) $(patsubst tests/%.c,$(B)/tests/%,$(wildcard tests/embed.c))
TEST_LIB := $(filter-out $(B)/obj/tests/test_% $(B)/obj/tests/bench_% $(B)/obj/tests/fuzz_% $(B)/obj/tests/embed.o,$(call objs,tests/*.c))
tests: $(TESTS) fuzzers
$(B)/tests/%: $(B)/obj/tests/%.o $(TEST_LIB) $(TOOL_LIBS)
	@mkdir -p $(@D)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ -lcmocka $(VULKAN_LIBS) $(GL_LIBS) $(HOST_LIBS)
# Stages of the tests' own, compiled as an engine would: tests/NAME.frag is
# included as NAME_frag.x (SPIR-V) and NAME_frag_glsl.x.
TEST_STAGES := $(foreach x,_frag _frag_glsl,$(patsubst tests/%.frag,$(GEN)/%$(x).x,$(wildcard tests/*.frag)))
$(GEN)/%_frag.x: tests/%.frag $(wildcard shaders/*.glsl shaders/shared/*.h)
	@mkdir -p $(GEN)
	@echo "  GLSL $@"
	$(Q)glslangValidator -V -g0 --target-env vulkan1.1 -Ishaders -I. -x -o $@ $< > $@.log || \
	    { cat $@.log; rm -f $@; exit 1; }
$(GEN)/%_frag_glsl.x: tests/%.frag shaders/embed.sh $(wildcard shaders/*.glsl shaders/shared/*.h)
	@mkdir -p $(GEN)
	@echo "  GLSL $@"
	$(Q)sh shaders/embed.sh stage $@ $<
$(filter-out $(B)/obj/tests/fuzz_%,$(call objs,tests/*.c)): | $(TEST_STAGES)
$(B)/tests/embed: $(B)/obj/tests/embed.o $(LIBS)
	@mkdir -p $(@D)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $< $(call lib,halflight-vulkan) $(call lib,halflight-packemu) $(call lib,halflight) $(VULKAN_LIBS) -pthread -lm

# Tests of core, hal and the software device for machines that have a C library
# and nothing else, with tests/minimal for cmocka; less those that an emulated
# processor takes minutes for.
PLAIN_TESTS := $(patsubst %,$(B)/plain/test_%,exact hal hal_faults ids ids_rates mesh mesh_tangent needs plan shade) \
  $(filter-out %/test_packemu_pass,$(patsubst tests/%.c,$(B)/plain/%,$(wildcard tests/test_packemu_*.c)))
plain-tests: $(PLAIN_TESTS)
$(B)/plain/obj/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	$(Q)$(CC) -Itests/minimal -DHL_NO_DRIVERS $(ALL_CFLAGS) $(HOST_CFLAGS) -MMD -MP -c -o $@ $<
$(B)/plain/test_%: $(B)/plain/obj/tests/test_%.o $(patsubst %,$(B)/plain/obj/%.o,tests/minimal/cmocka tests/check \
    tests/mesh_kit tests/frame_kit tests/kernel_kit tests/packemu_kit tests/raster_kit platforms/platforms platforms/null/null) $(PACKEMU_LIBS)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ -pthread -lm

# Fuzzers: with a main of their own for any compiler and the suites' smoke run,
# or libFuzzer's.
FUZZERS := $(patsubst %,$(B)/fuzz/%,fuzz_plan fuzz_packemu)
FUZZ_MAIN = $(B)/obj/tests/fuzz_main.o
FUZZ_SECONDS ?= 600
fuzzers: $(FUZZERS)
fuzz:
	@$(MAKE) --no-print-directory CC=clang B=build/fuzz FUZZ_MAIN= FUZZ_LDFLAGS=-fsanitize=fuzzer,address,undefined \
	    CFLAGS="-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined" fuzzers
	@for f in $(notdir $(FUZZERS)); do \
	    mkdir -p build/fuzz/corpus/$$f; \
	    nice build/fuzz/fuzz/$$f -max_total_time=$$(($(FUZZ_SECONDS) / $(words $(FUZZERS)))) -max_len=4096 -len_control=0 \
	        -timeout=20 -artifact_prefix=build/fuzz/$$f- build/fuzz/corpus/$$f || exit 1; \
	done
$(FUZZERS): $(B)/fuzz/%: $(B)/obj/tests/%.o $(B)/obj/tests/fuzz_kit.o $(FUZZ_MAIN) $(filter %/plan_text.o %/plan_reason.o,$(PLAIN)) $(PACKEMU_LIBS)
	@mkdir -p $(@D)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) $(FUZZ_LDFLAGS) -o $@ $^ -pthread -lm

deps:
	@sh .ci/deps
run: deps
	@$(MAKE) $(JOBS) --no-print-directory all
	@sh .ci/demo $(B)/halflight build/demo
test: deps
	@$(MAKE) $(JOBS) --no-print-directory all tests
	@sh tests/run.sh $(B)
check: all
	@sh tests/check.sh $(B)
# Published results as ratios, growth with objects and lights, and what parts
# take; ROUNDS and FRAMES (5 or 3, 20 or 5) may be set.
bench: all $(B)/tests/bench_growth $(B)/tests/bench_light $(B)/tests/bench_stipple
	@echo "RES-1 to RES-4: ratios of frame times, and the paper's (Kircher, Lawrance 2009)"
	@ROUNDS=$${ROUNDS:-3} FRAMES=$${FRAMES:-5} sh tests/published.sh $(B)/halflight
	@echo
	@$(B)/tests/bench_growth
	@echo
	@sh tests/bench.sh $(B)/halflight fig8
	@$(B)/tests/bench_light
	@$(B)/tests/bench_stipple
docs: tool $(B)/docs-tables
	@sh docs/make-tables.sh $(B)/halflight $(B)/docs-tables
	@sh docs/make-stability.sh $(B)/halflight
	@sh docs/make-charts.sh $(B)/halflight
$(B)/docs-tables: $(B)/obj/docs/tables.o
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ -lcjson
clean:
	rm -rf build

-include $(shell find $(B) -name '*.d' 2>/dev/null)
.SECONDARY:
