// Colours that follow the page. The colours of felt and cables come from palette.py, as a prop.

const LIGHT = {
  back: "#faf8f6", grid: "#efebed", ink: "#2b2833", muted: "#6d6876", paper: "#ffffff",
  ghost: "#b4afbc", accent: "#0b5fa5",
  axes: { x: "#c8443f", y: "#4f8a2b", z: "#2f6fc0" },
};
const DARK = {
  back: "#1a1820", grid: "#24212b", ink: "#efecf2", muted: "#a7a1af", paper: "#221f29",
  ghost: "#8b8498", accent: "#6db3ec",
  axes: { x: "#f08078", y: "#93cf6b", z: "#7db4f5" },
};

export function theme(dark) {
  return dark ? DARK : LIGHT;
}

/** Opacity of what is proposed only. */
export const FAINT = 0.5;

/**
 * Red, green and blue, 0 to 1, of a colour such as "#0b5fa5".
 * @returns {[number, number, number]}
 */
export function rgb(hex) {
  const number = parseInt(hex.slice(1), 16);
  return [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
}

/** A colour with a share, 0 to 1, of another. */
export function mix(colour, other, share) {
  const [a, b] = [rgb(colour), rgb(other)];
  return "#" + a.map((value, i) => Math.round(255 * (value + share * (b[i] - value))).toString(16).padStart(2, "0")).join("");
}

/** A colour of some opacity, for a canvas. */
export function veil(colour, opacity) {
  return `rgba(${rgb(colour).map((value) => Math.round(255 * value)).join(",")},${opacity})`;
}

/** The colour at a share, 0 to 1, of a row of colours. */
export function ramp(colours, share) {
  const place = Math.min(Math.max(share, 0), 1) * (colours.length - 1);
  const first = Math.min(Math.floor(place), colours.length - 2);
  return mix(colours[first], colours[first + 1], place - first);
}
