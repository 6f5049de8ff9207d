"""How the report looks: light, dark, narrow and on paper."""

STYLE = """
:root { color-scheme: light dark; --paper: #ffffff; --card: #ffffff; --page: #faf8f6; --ink: #2b2833; --soft: #5d5967;
  --muted: #85808f; --grid: #ebe8ee; --line: #e6e1e3; --ghost: #b4afbc; --ghost-fill: #f3f1f5; --warm: #b9774b;
  --error: #c8243f; --figure-font: ui-sans-serif, system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue",
  "Liberation Sans", Arial, sans-serif; }
@media (prefers-color-scheme: dark) { :root { --paper: #1d1b21; --card: #1d1b21; --page: #151318; --ink: #efebf3;
  --soft: #bcb6c5; --muted: #948d9f; --grid: #2d2a33; --line: #312d37; --ghost: #6d6678; --ghost-fill: #2a2731;
  --warm: #e5a878; --error: #ff7085; } svg.figure { filter: brightness(.94); } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.6 var(--figure-font);
  -webkit-font-smoothing: antialiased; }
main { max-width: 1120px; margin: 0 auto; padding: 0 clamp(16px, 4vw, 40px); overflow-wrap: break-word; }
h1 { font-size: clamp(2.1rem, 5.5vw, 3.6rem); line-height: 1.08; letter-spacing: -.03em; margin: .1em 0 .3em;
  text-wrap: balance; }
h2 { font-size: 1.55rem; letter-spacing: -.015em; line-height: 1.25; margin: 0 0 .35em; }
h3 { font-size: 1rem; margin: 1.8em 0 .6em; }
p { margin: 0 0 1em; max-width: 68ch; color: var(--soft); }
.eyebrow { color: var(--warm); font-size: .8rem; font-weight: 650; letter-spacing: .09em; text-transform: uppercase;
  margin: 0 0 .4em; }
.hero { padding: clamp(36px, 7vw, 84px) 0 8px; }
.hero > p { font-size: 1.12rem; }
.path { display: flex; flex-wrap: wrap; align-items: stretch; gap: 12px; margin: 30px 0 34px; padding: 0;
  list-style: none; }
.path li { flex: 1 1 190px; padding: 16px 20px 15px; border: 1px solid var(--line); border-radius: 16px;
  background: var(--card); }
.path b { display: block; font-size: clamp(1.9rem, 4vw, 2.6rem); letter-spacing: -.03em; line-height: 1.15;
  font-variant-numeric: tabular-nums; }
.path small { font-size: .95rem; font-weight: 500; color: var(--muted); letter-spacing: 0; margin-left: .25em; }
.path span { color: var(--soft); font-size: .9rem; }
.path li.best { border-color: var(--warm); box-shadow: 0 0 0 1px var(--warm); }
.grid { display: grid; gap: 20px; grid-template-columns: repeat(auto-fit, minmax(min(100%, 430px), 1fr));
  margin: 22px 0; }
.small { grid-template-columns: repeat(auto-fit, minmax(min(100%, 300px), 1fr)); }
.tiny { grid-template-columns: repeat(auto-fill, minmax(min(100%, 220px), 1fr)); gap: 14px; }
.tiny figure { padding: 12px 12px 10px; border-radius: 14px; }
.note { padding: 16px 20px; margin: 20px 0 0; border-left: 3px solid var(--warm); background: var(--card); }
.note b { color: var(--ink); }
.one { grid-template-columns: minmax(0, 780px); }
figure { margin: 0; padding: 18px 18px 14px; background: var(--card); border: 1px solid var(--line);
  border-radius: 18px;
  display: flex; flex-direction: column; break-inside: avoid; min-width: 0; }
figure svg { width: 100%; height: auto; display: block; margin: auto 0; }
figcaption { font-size: .88rem; color: var(--soft); padding-top: 10px; line-height: 1.45; }
figcaption b { color: var(--ink); }
section { padding: clamp(30px, 5vw, 56px) 0 0; }
section > header { display: grid; grid-template-columns: auto minmax(0, 1fr); gap: 0 16px; }
.step { width: 34px; height: 34px; border-radius: 50%; display: grid; place-items: center; font-weight: 650;
  border: 1.5px dashed var(--warm); color: var(--warm); font-size: .95rem; margin-top: 1px; }
.table { overflow-x: auto; margin: 0 0 12px; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 550; color: var(--muted); font-size: .8rem; vertical-align: bottom; }
td { white-space: nowrap; }
th, td { padding: 8px 12px 8px 0; border-bottom: 1px solid var(--line); }
td:last-child, th:last-child { padding-right: 0; }
.number { text-align: right; }
th { white-space: normal; line-height: 1.3; }
.bar { display: inline-block; width: 100%; min-width: 84px; height: 8px; border-radius: 4px; background: var(--grid);
  overflow: hidden; vertical-align: middle; }
.bar i { display: block; height: 100%; border-radius: 4px; }
@media (prefers-color-scheme: dark) { .bar i { box-shadow: inset 0 0 0 1px rgb(255 255 255 / .4); } }
.swatch { display: inline-block; width: 10px; height: 10px; border-radius: 50%; margin-right: 8px; }
.error { color: var(--error); font-weight: 600; }
.pose { display: grid; gap: 8px 32px; grid-template-columns: repeat(auto-fit, minmax(min(100%, 430px), 1fr));
  align-items: start; margin: 22px 0 40px; }
@media (min-width: 960px) { .pose figure { position: sticky; top: 20px; } }
.pose h3:first-child { margin-top: .2em; }
.quiet { color: var(--muted); font-size: .88rem; }
footer { margin: 64px 0 0; padding: 30px 0 60px; border-top: 1px solid var(--line); }
footer td { white-space: normal; overflow-wrap: anywhere; }
footer td:first-child { color: var(--muted); width: 34%; }
code { font: .86em ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
svg.figure * { stroke-linejoin: round; }
svg.figure text { font-family: var(--figure-font); }
svg.figure .halo text { paint-order: stroke; stroke: var(--paper); stroke-width: 2.6px; stroke-linejoin: round;
  stroke-opacity: .85; }
.still { display: none; }
@media print, (prefers-reduced-motion: reduce) { .moving { display: none; } .still { display: flex; } }
@page { margin: 14mm; }
@media print { :root { --page: #fff; } body { font-size: 11px; } main { padding: 0; } section { padding-top: 22px; }
  figure, .path li, tr { break-inside: avoid; } h2, h3, section > header { break-after: avoid; }
  figure { padding: 8px; border-radius: 10px; } .pose figure { position: static; } .hero { padding-top: 0; }
  .path { flex-wrap: nowrap; } .path li { flex: 1 1 0; padding: 8px 12px; } .path b { font-size: 1.6rem; }
  .grid, .pose { grid-template-columns: 1fr 1fr; gap: 10px 14px; margin: 10px 0 16px; }
  .small { grid-template-columns: 1fr 1fr 1fr; } th, td { padding: 3px 8px 3px 0; font-size: 9.5px; }
  .bar { min-width: 40px; } h1 { font-size: 2rem; } h3 { margin: 1em 0 .3em; } }
"""
