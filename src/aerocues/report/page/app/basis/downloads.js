/* Files to save: tables as CSV, and pictures. */

import {make} from "./elements.js";

/** @param {string} name @param {string | Blob | null} content @param {string} type */
export function saveFile(name, content, type) {
  if (content === null) return;
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type}));
  const link = make("a", {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** @param {unknown} value */
function csvCell(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  const text = String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** @param {string[]} header @param {unknown[][]} rows */
function csvOf(header, rows) {
  return [header, ...rows].map(row => row.map(csvCell).join(",")).join("\r\n") + "\r\n";
}

/** @param {string} name @param {string[]} header @param {unknown[][]} rows */
export function saveCsv(name, header, rows) {
  saveFile(`${name}.csv`, csvOf(header, rows), "text/csv;charset=utf-8");
}

/** @param {...string} parts */
export function fileStem(...parts) {
  return parts.join("-").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
}
