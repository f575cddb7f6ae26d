# halflight. make              the tool and the libraries, in build/$(config)
#            make run          install what is missing, build, draw, report
#            make test         install what is missing, build, run all suites
#            make check        include arrows, undefined symbols, headers alone
# config=debug|release|sanitize|coverage
config ?= release
ifeq ($(origin CC),default)
CC := gcc
endif
AR ?= ar
B := build/$(config)
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
HOST := $(call objs,platforms/host/*.c)
REFERENCE := $(call objs,platforms/reference/*.c)
CLI_LIB := $(filter-out $(B)/obj/platforms/cli/main.o,$(call objs,platforms/cli/*.c))
LIST := $(B)/obj/platforms/platforms.o

LIBS := $(call lib,halflight) $(call lib,halflight-null) $(call lib,halflight-vulkan) $(call lib,halflight-gl)
TOOL_LIBS := $(call lib,halflight-cli) $(call lib,halflight-host) $(call lib,halflight-reference) \
  $(call lib,halflight-list) $(call lib,halflight-vulkan) $(call lib,halflight-gl) $(call lib,halflight-null) $(call lib,halflight)

.PHONY: all libs tool run test tests check deps clean bench
all: tool libs
libs: $(LIBS)
tool: $(B)/halflight

$(call lib,halflight): $(HAL)
$(call lib,halflight-null): $(NULLB)
$(call lib,halflight-vulkan): $(VULKAN)
$(call lib,halflight-gl): $(GL)
$(call lib,halflight-host): $(HOST)
$(call lib,halflight-reference): $(REFERENCE)
$(call lib,halflight-cli): $(CLI_LIB)
$(call lib,halflight-list): $(LIST)
%.a:
	@mkdir -p $(@D); rm -f $@
	@echo "  AR   $@"
	$(Q)$(AR) rcs $@ $^

$(B)/halflight: $(B)/obj/platforms/cli/main.o $(TOOL_LIBS)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(VULKAN_LIBS) $(GL_LIBS) $(HOST_LIBS)

$(B)/obj/platforms/host/%.o $(B)/obj/platforms/cli/%.o $(B)/obj/platforms/reference/%.o $(B)/obj/tests/%.o: EXTRA := $(HOST_CFLAGS)
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
TEST_LIB := $(filter-out $(B)/obj/tests/test_% $(B)/obj/tests/embed.o,$(call objs,tests/*.c))
tests: $(TESTS)
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
$(call objs,tests/*.c): | $(TEST_STAGES)
$(B)/tests/embed: $(B)/obj/tests/embed.o $(LIBS)
	@mkdir -p $(@D)
	@echo "  LINK $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $< $(call lib,halflight-vulkan) $(call lib,halflight) $(VULKAN_LIBS) -lm

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
bench: all
	@sh tests/bench.sh $(B)/halflight fig8
clean:
	rm -rf build

-include $(shell find $(B) -name '*.d' 2>/dev/null)
.SECONDARY:
