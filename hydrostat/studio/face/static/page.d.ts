// What the page brings that no module of ours exports: read by `make lint-js` alone.

declare module "nicegui-scene" {
  import * as THREE from "three";
  export { THREE };
}

interface Window {
  /** What tests may look at, while there is a view. */
  __app?: import("./view/probe.js").Probe;

  /** NiceGUI's. */
  emitEvent: (name: string) => void;
}

/** A Vue component as NiceGUI takes it: options, whose methods see its data as `this`. */
type Component = { template: string } & Record<string, unknown> & ThisType<any>;
