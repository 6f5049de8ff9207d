// Rules for the JavaScript of the studio and of shared pages; types are checked by tsc (tsconfig.json).
import js from "@eslint/js";

const page = ["window", "document", "console", "location", "performance", "WebSocket", "URL", "Path2D", "ResizeObserver",
  "MutationObserver", "requestAnimationFrame", "cancelAnimationFrame", "setTimeout", "clearTimeout", "getComputedStyle",
  "TextDecoder", "TextEncoder", "navigator", "atob", "setInterval", "addEventListener", "getSelection", "Element",
  "HTMLElement"];

export default [
  js.configs.recommended,
  {
    files: ["hydrostat/studio/face/static/**/*.js", "hydrostat/toy/static/*.js"],
    languageOptions: { globals: Object.fromEntries(page.map((name) => [name, "readonly"])) },
    rules: {
      eqeqeq: "error",
      "no-var": "error",
      "prefer-const": ["error", { destructuring: "all" }],
      "no-unused-vars": ["error", { args: "after-used" }],
      "no-shadow-restricted-names": "error",
      complexity: ["error", 20],
      "max-lines": ["error", 400],
    },
  },
];
