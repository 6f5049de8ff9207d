// What the Vue component beside this folder needs of it.
export { View } from "./view.js";
