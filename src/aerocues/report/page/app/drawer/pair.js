/* One pair of images in the drawer: both images, and what each of the best combinations found. */

import {make, plainTable} from "../basis/elements.js";
import {firstColumn, pairLabel, pairValues} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {duration, labelOf, sentenceCase, shown, valueText} from "../basis/numbers.js";
import {arrayOf, payload} from "../basis/payload.js";
import {currentEntry, state} from "../basis/state.js";
import {closeDrawer, showDrawer} from "./drawer.js";

const ROWS = 12;
const COUNTS = ["ref_matches@3", "excess_inliers", "inliers", "matches"];
const SHARES = ["gt_precision@3", "ref_precision@3", "precision_beyond_chance", "precision"];

/** @param {number} position */
export function openPair(position) {
  const entry = currentEntry();
  const pair = entry.pairs[position];
  const pictures = payload.pictures.filter(each => each.entry === entry.name && each.pair === position);
  const show = pictures.length ? make("button", {type: "button", class: "quiet", onclick: () => {
    closeDrawer();
    state.set({"picture.pair": String(position)});
    document.getElementById("pictures")?.scrollIntoView({block: "start"});
  }}, "Show its matches") : make("p", {class: "note"}, "No picture of its matches is in this page; the option --pictures draws more.");
  showDrawer(pairLabel(entry, position), [
    make("div", {class: "two-images"}, [pair.image_1, pair.image_2].map(name => pictureOf(entry, name))), show, tableOfPair(entry, position)]);
}

/** @param {Entry} entry @param {string} name */
function pictureOf(entry, name) {
  const large = payload.images[`${entry.name}/${name}`]?.src;
  const small = payload.maps.find(each => each.entry === entry.name)?.images.find(image => image.name === name)?.src;
  const src = large ?? small;
  return make("figure", {}, src ? make("img", {src, alt: ""}) : null, make("figcaption", {}, name));
}

/** The best combinations that were measured on the pair, those with the most right matches first.
 * @param {Entry} entry @param {number} position */
function tableOfPair(entry, position) {
  const [count, share] = [firstColumn(entry, COUNTS), firstColumn(entry, SHARES)];
  const status = arrayOf(entry.status);
  const unknown = entry.statuses.indexOf("not measured");
  const of = (/** @type {string | null} */ column, /** @type {number} */ a) => (column ? pairValues(entry, column, a)[position] : NaN);
  const measured = shownIn(entry).filter(a => status[a * entry.pairs.length + position] !== unknown);
  const rows = [...measured].sort((a, b) => (of(count, b) || 0) - (of(count, a) || 0)).slice(0, ROWS);
  return plainTable(`The best ${rows.length} of ${measured.length} combinations on this pair`, [
    {label: "Combination", text: a => entry.combinations[a]},
    {label: "Status", text: a => entry.statuses[status[a * entry.pairs.length + position]]},
    ...(count ? [{label: sentenceCase(labelOf(count)), number: true, text: (/** @type {number} */ a) => shown(of(count, a))}] : []),
    ...(share ? [{label: sentenceCase(labelOf(share)), number: true, text: (/** @type {number} */ a) => valueText(share, of(share, a))}] : []),
    {label: "Time", number: true, text: a => duration(entry.columns.total_seconds ? of("total_seconds", a) : null)},
  ], rows);
}
