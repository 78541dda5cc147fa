# The two commands: `make demo` and `make test`. Each installs what is missing first.
#
#   make demo     builds, searches, maps and matches sample surfaces, leaves demo/index.html
#   make test     builds and runs every test; leaves build/release/bin built
#   make build    only the release build
#   make bench    costs of every stage in F on a sample surface (MESHES="a.obj b.off" for others)
#   make format   runs clang-format over the sources
#   make tidy     runs clang-tidy over the sources (slow)
#   make fuzz     fuzzes the mesh readers for FUZZ_SECONDS each
#   make clean    removes build/ and demo/

BUILD_PACKAGES := g++ cmake ninja-build ccache pkg-config \
  libeigen3-dev libopenmesh-dev libflann-dev liblz4-dev \
  libsuitesparse-dev libgomp1 libopenblas-pthread-dev libopenblas0-pthread \
  libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc \
  libsqlite3-dev libzstd-dev libssl-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libtinygltf-dev \
  libcairo2-dev fonts-dejavu-core libexpat1-dev zlib1g-dev \
  libgtest-dev libgmock-dev libbenchmark-dev libspectra-dev
TEST_PACKAGES := $(BUILD_PACKAGES) clang-format clang-19 libclang-rt-19-dev

# For validating glTF; that test is skipped where there is no npm.
NPM_PACKAGES := gltf-validator@2.0.0-dev.3.10

JOBS ?= $(shell nproc)
MESHES ?=
FUZZ_SECONDS ?= 600
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
# Debian's OpenBLAS starts a thread per core for every small block; ours are where they pay.
export OPENBLAS_NUM_THREADS := 1
# Checkouts in different folders share what was compiled.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := 1

.PHONY: demo test build bench format tidy fuzz clean install-build install-test

# $(call install,packages): asks for nothing when all is there.
define install
missing=(); \
for package in $(1); do \
  dpkg-query -W -f='$${db:Status-Status}' "$$package" 2>/dev/null | grep -qx installed || missing+=("$$package"); \
done; \
if (($${#missing[@]})); then \
  echo "installing $${missing[*]}"; \
  sudo=; if [ "$$(id -u)" -ne 0 ]; then sudo=sudo; fi; \
  $$sudo apt-get update -qq; \
  $$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$${missing[@]}"; \
fi
endef

install-build:
	@$(call install,$(BUILD_PACKAGES))

install-test:
	@$(call install,$(TEST_PACKAGES))
	@if command -v npm >/dev/null && [ ! -d build/npm/node_modules/gltf-validator ]; then \
	  npm install --silent --no-fund --no-audit --no-save --prefix build/npm $(NPM_PACKAGES) || \
	    echo "npm failed: glTF files are not validated"; \
	fi

build: install-build
	cmake --preset release -Wno-dev
	cmake --build --preset release -j $(JOBS)

demo: build
	tests/demo/run.sh build/release/bin demo

test: install-test build
	ctest --preset release -j $(JOBS)
	cmake --preset asan -Wno-dev
	cmake --build --preset asan -j $(JOBS) --target sanitized_tests
	ctest --preset asan -j $(JOBS) -L asan
	cmake --preset tsan -Wno-dev
	cmake --build --preset tsan -j $(JOBS) --target tsan_tests
	ctest --preset tsan -j $(JOBS) -L tsan
	cmake --preset fuzz -Wno-dev
	cmake --build --preset fuzz -j $(JOBS) --target fuzz_tests
	ctest --test-dir build/fuzz --output-on-failure -L fuzz

bench: build
	build/release/bin/moduli_bench $(MESHES)

format:
	find core server client tests -name '*.h' -o -name '*.cc' | xargs clang-format -i

tidy: install-test
	@$(call install,clang-tidy)
	cmake --preset release -Wno-dev
	find core server client -name '*.cc' | xargs -P $(JOBS) -n 4 clang-tidy -p build/release --quiet

clean:
	rm -rf build demo
