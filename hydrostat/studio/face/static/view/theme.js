// Colors that follow the page. The colors of felt and cables come from palette.py, as a prop.

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
export const FAINT = 0.6;

/**
 * Red, green and blue, 0 to 1, of a color such as "#0b5fa5".
 * @returns {[number, number, number]}
 */
export function rgb(hex) {
  const number = parseInt(hex.slice(1), 16);
  return [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
}

/** A color with a share, 0 to 1, of another. */
export function mix(color, other, share) {
  const [a, b] = [rgb(color), rgb(other)];
  return "#" + a.map((value, i) => Math.round(255 * (value + share * (b[i] - value))).toString(16).padStart(2, "0")).join("");
}

/** A color of some opacity, for a canvas. */
export function veil(color, opacity) {
  return `rgba(${rgb(color).map((value) => Math.round(255 * value)).join(",")},${opacity})`;
}

/** The color at a share, 0 to 1, of a row of colors. */
export function ramp(colors, share) {
  const place = Math.min(Math.max(share, 0), 1) * (colors.length - 1);
  const first = Math.min(Math.floor(place), colors.length - 2);
  return mix(colors[first], colors[first + 1], place - first);
}
