/* The state of the view: texts by key, kept in the fragment of the URL so that a view can be shared. */

import {entries} from "./entries.js";

export const state = {
  /** @type {Map<string, string>} */
  values: new Map(),
  /** @type {((changed: Set<string>) => void)[]} */
  listeners: [],

  /** @param {string} key @param {string} [fallback] */
  get(key, fallback = "") {
    return this.values.get(key) ?? fallback;
  },

  /** Sets keys to texts; null or "" restores the default.
   * @param {Record<string, string | null>} changes */
  set(changes) {
    /** @type {Set<string>} */
    const changed = new Set();
    for (const [key, value] of Object.entries(changes)) {
      if ((this.values.get(key) ?? "") === (value ?? "")) continue;
      if (value === null || value === "") this.values.delete(key);
      else this.values.set(key, value);
      changed.add(key);
    }
    if (!changed.size) return;
    this.write();
    this.tell(changed);
  },

  /** @param {Set<string>} changed */
  tell(changed) {
    for (const listener of this.listeners) listener(changed);
  },

  /** @param {(changed: Set<string>) => void} listener */
  onChange(listener) {
    this.listeners.push(listener);
  },

  write() {
    const fragment = new URLSearchParams([...this.values].sort()).toString();
    history.replaceState(null, "", fragment ? `#${fragment}` : location.pathname + location.search);
  },

  /** Reads the fragment and returns the changed keys. `#quality` alone is a link to a section.
   * @returns {Set<string>} */
  read() {
    const fragment = location.hash.slice(1);
    const before = this.values;
    if (fragment && !fragment.includes("=")) return new Set();
    this.values = new Map([...new URLSearchParams(fragment)].filter(([, value]) => value));
    const keys = new Set([...before.keys(), ...this.values.keys()]);
    return new Set([...keys].filter(key => before.get(key) !== this.values.get(key)));
  },
};

export function currentEntry() {
  return entries.find(entry => entry.name === state.get("entry")) ?? entries[0];
}
