/// What comes from outside is text, never markup: it is shown by textContent, without characters that control a display,
/// and cut.
export const cut = (value, most = 300) => {
  const text = String(value ?? "").slice(0, 2 * most).replace(/[\u0000-\u001f\u007f-\u009f\u200e\u200f\u202a-\u202e\u2066-\u2069\ufeff]/g, "\u2423");
  return text.length > most ? text.slice(0, most) + "\u2026" : text;
};

export const finite = (value, most = 1e300) => typeof value === "number" && Number.isFinite(value) && Math.abs(value) <= most;

const two = (n) => String(Math.floor(n)).padStart(2, "0");

/// Time of day of a time in ms, with the date if it is not today.
export const clock = (ms) => {
  const t = new Date(ms), day = `${t.getFullYear()}-${two(t.getMonth() + 1)}-${two(t.getDate())}`;
  const time = `${two(t.getHours())}:${two(t.getMinutes())}:${two(t.getSeconds())}`;
  return t.toDateString() === new Date().toDateString() ? time : `${day} ${time}`;
};

/// A duration in s in words.
export const span = (seconds) => {
  const s = Math.max(0, seconds);
  return s < 100 ? `${Math.round(s)} s` : s < 5400 ? `${Math.round(s / 60)} min` : s < 172800 ? `${Math.round(s / 3600)} h` : `${Math.round(s / 86400)} days`;
};

/// An element with a text.
export const element = (name, text, className) => {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
};
