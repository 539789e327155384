/* What to copy to use the answer: a command, and code. */

import {announce, make} from "../basis/elements.js";
import {fileStem} from "../basis/downloads.js";

/** @param {Entry} entry @param {string} name */
export function commandOf({models}, name) {
  if (name === models?.baseline) return "colmap automatic_reconstructor --image_path PHOTOS --workspace_path model --dense 0";
  return `aerocues use ${name} --as python -o ${fileStem(name).replaceAll("-", "_")}.py`;
}

/** @param {Entry} entry @param {string} name */
export function codeOf(entry, name) {
  const {limit} = /** @type {{limit?: {count?: number}}} */ (entry.run.protocol ?? {});
  const most = limit?.count ? `, max_keypoints=${limit.count}` : "";
  if (name === entry.models?.baseline) return "import pycolmap\n\npycolmap.extract_features(\"database.db\", \"PHOTOS\")\npycolmap.match_exhaustive(\"database.db\")\n"
    + "pycolmap.incremental_mapping(\"database.db\", \"PHOTOS\", \"model\")\n";
  return `import aerocues\n\nfound = aerocues.match("a.jpg", "b.jpg", "${name}"${most})\nprint(found)\n`;
}

/** A button that copies a text, beside the text itself, which can be selected where copying is not allowed.
 * @param {string} label @param {string} text */
export function copyButton(label, text) {
  const button = make("button", {type: "button", class: "quiet", onclick: async () => {
    const done = await copied(text);
    button.textContent = done ? "Copied" : "Select and copy the text below";
    announce(button.textContent);
    setTimeout(() => { button.textContent = label; }, 2500);
  }}, label);
  return button;
}

/** @param {string} text */
async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch (error) {
    if (error instanceof DOMException || error instanceof TypeError) return false; // not allowed, or not there
    throw error;
  }
}
