// Simulated PLCs, and the client engines of the backends, as processes.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";

export const programs = process.env.BUSBAR_PROGRAMS;

export const program = (name) => join(programs, name);
export const hasProgram = (name) => existsSync(program(name));
export const isInstalled = (name) => spawnSync(name, ["--version"]).error === undefined;

/** A program that prints "ready at HOST:PORT", and a line for each command. */
export class Plc {
  static async start(name, ...args) {
    const plc = new Plc();
    plc.process = spawn(program(name), args, { stdio: ["pipe", "pipe", "inherit"] });
    plc.exit = new Promise((resolve) => plc.process.on("exit", (code, signal) => resolve(code ?? signal)));
    plc.lines = createInterface({ input: plc.process.stdout })[Symbol.asyncIterator]();
    const { value } = await plc.lines.next();
    plc.port = Number(/^ready at .*:(\d+)$/.exec(value)?.[1]);
    assert.ok(plc.port > 0, value);
    return plc;
  }
  async say(command) {
    this.process.stdin.write(`${command}\n`);
    return (await this.lines.next()).value;
  }
  /** Ends the program and returns its exit code. */
  stop() {
    this.process.kill();
    return this.exit;
  }
}

/** Answers of a PLC at `port` to requests of our client engine, each a line; see plc_client.cpp. */
export async function ask(protocol, port, options, requests) {
  const child = spawn(program("plc-client"), [protocol, String(port), ...options, ...requests]);
  let output = "";
  let errors = "";
  child.stdout.on("data", (data) => (output += data));
  child.stderr.on("data", (data) => (errors += data));
  const code = await new Promise((resolve) => child.on("close", resolve));
  assert.equal(code, 0, errors);
  return output.trimEnd().split("\n");
}

/** Runs a program of others and returns what it printed. */
export async function run(name, ...args) {
  const child = spawn(name, args);
  let output = "";
  child.stdout.on("data", (data) => (output += data));
  child.stderr.on("data", (data) => (output += data));
  await new Promise((resolve) => child.on("close", resolve));
  return output;
}

/** "ok 5 6 7": numbers from `first` on. */
export const counting = (first, count) => ["ok", ...Array.from({ length: count }, (_, i) => first + i)].join(" ");
