# What a newcomer needs: `make run`, `make test`. Everything a target needs it sets up itself.
SHELL := /bin/bash
export PATH := $(PATH):$(HOME)/.cargo/bin
SOIFRA := target/release/soifra
MISSION ?= missions/soifra/room.soi
SEED ?= 1
# What the start of the program is measured with.
SHORT := missions/khepera/sim1.soi

.PHONY: help setup build run test results bench fmt lint docs clean

help:
	@echo 'make run      build, run a mission, draw it'
	@echo 'make test     the whole suite'
	@echo 'make results  every measured bar in full; rewrites docs/results.md (resumable, hours)'
	@echo 'make bench    speed against reference implementations'
	@echo 'make fmt      bring Rust and .soi sources into form'

setup:
	@tools/setup

build: setup
	@cargo build --release --quiet

run: build
	@tools/run-mission $(SOIFRA) $(MISSION) $(SEED)

test: setup
	@tools/test

results: build
	@tools/results $(SOIFRA)

bench: setup
	@cargo bench --bench engine --bench swarm --bench check --bench run --bench message --bench matcher \
	  --bench agents --bench room -- --quiet

fmt: setup
	@cargo fmt --all
	@cargo build --quiet && git ls-files '*.soi' | grep -v '/golden/' | xargs -r target/debug/soifra fmt

lint: setup
	@tools/lint

docs: setup
	@RUSTDOCFLAGS='-D warnings' cargo doc --workspace --no-deps --quiet

clean:
	@cargo clean && rm -rf out
