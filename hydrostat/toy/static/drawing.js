// Draws a robot on a canvas: a flat body as felt with a seam, then cables, winches and markers.

const FELT = "#f0c29c", FELT_LIGHT = "#f8d9bd", SEAM = "#b9774b", STITCH = "#fff1e2", DARK = "#2a2732", LIGHT = "#fffdfb";

/**
 * @param {CanvasRenderingContext2D} paper
 * @param {any} sight
 * @param {any} data
 * @param {Float64Array} points
 * @param {{held: number, goal: number[] | null, ink: string, dots: boolean}} state dots: draw a surface as dots
 */
export function draw(paper, sight, data, points, state) {
  paper.clearRect(0, 0, sight.width, sight.height);
  const unit = Math.max(0.7, Math.min(sight.width, sight.height) / 420);
  if (data.dim === 2) drawFelt(paper, sight, data, points, unit);
  let cable = 0;
  for (const [kind, first, count] of data.groups) {
    if (kind === "surface" && state.dots) drawDots(paper, sight, points, first, count, unit);
    if (kind === "drawn") line(paper, sight, data, points, first, count, DARK, 2 * unit);
    if (kind === "cable") {
      const color = data.winches[data.cables[cable++]].color;
      paper.globalAlpha = data.dim === 2 ? 1 : 0.75;
      line(paper, sight, data, points, first, count, color, 2.4 * unit);
      paper.globalAlpha = 1;
      dot(paper, sight.see(points, data.dim * (first + count - 1)), 3.2 * unit, color);
    }
    if (kind === "winch") for (let i = 0; i < count; i++) winch(paper, sight.see(points, data.dim * (first + i)), data.winches[i], unit);
    if (kind === "marker") for (let i = 0; i < count; i++) marker(paper, sight.see(points, data.dim * (first + i)), first + i === state.held, unit);
  }
  if (state.goal) goal(paper, sight, points, data, state, unit);
}

function drawFelt(paper, sight, data, points, unit) {
  paper.beginPath();
  for (const [kind, first, count] of data.groups) if (kind === "outline") trace(paper, sight, data, points, first, count, true);
  const glow = paper.createLinearGradient(0, 0, 0, sight.height);
  glow.addColorStop(0, FELT_LIGHT);
  glow.addColorStop(1, FELT);
  paper.fillStyle = glow;
  paper.fill("evenodd");
  paper.strokeStyle = SEAM;
  paper.lineWidth = 2 * unit;
  paper.lineJoin = "round";
  paper.stroke();
  paper.beginPath();
  for (const [kind, first, count] of data.groups) if (kind === "seam") trace(paper, sight, data, points, first, count, true);
  paper.strokeStyle = STITCH;
  paper.lineWidth = 1.6 * unit;
  paper.setLineDash([5 * unit, 4 * unit]);
  paper.stroke();
  paper.setLineDash([]);
}

/** Points of a surface, the far ones first. */
function drawDots(paper, sight, points, first, count, unit) {
  const seen = Array.from({ length: count }, (_, i) => sight.see(points, 3 * (first + i))).sort((one, two) => one[2] - two[2]);
  const side = 3.2 * unit, [far, near] = [seen[0][2], seen[count - 1][2]];
  for (const [x, y, depth] of seen) {
    paper.fillStyle = depth - far > 0.5 * (near - far) ? FELT : SEAM;
    paper.fillRect(x - side / 2, y - side / 2, side, side);
  }
}

function trace(paper, sight, data, points, first, count, closed) {
  for (let i = 0; i < count; i++) {
    const [x, y] = sight.see(points, data.dim * (first + i));
    if (i) paper.lineTo(x, y);
    else paper.moveTo(x, y);
  }
  if (closed) paper.closePath();
}

function line(paper, sight, data, points, first, count, color, width) {
  paper.beginPath();
  trace(paper, sight, data, points, first, count, false);
  paper.strokeStyle = color;
  paper.lineWidth = width;
  paper.lineCap = paper.lineJoin = "round";
  paper.stroke();
}

function dot(paper, [x, y], radius, color, edge = "") {
  paper.beginPath();
  paper.arc(x, y, radius, 0, 2 * Math.PI);
  paper.fillStyle = color;
  paper.fill();
  if (!edge) return;
  paper.strokeStyle = edge;
  paper.lineWidth = radius / 4;
  paper.stroke();
}

function winch(paper, place, { color, mark }, unit) {
  dot(paper, place, 9 * unit, color, LIGHT);
  paper.fillStyle = LIGHT;
  paper.font = `600 ${(mark.length > 2 ? 6.5 : 8) * unit}px system-ui, sans-serif`;
  paper.textAlign = "center";
  paper.textBaseline = "middle";
  paper.fillText(mark, place[0], place[1] + 0.5);
}

function marker(paper, place, held, unit) {
  dot(paper, place, (held ? 9 : 7) * unit, LIGHT, DARK);
  dot(paper, place, 2.6 * unit, DARK);
}

/** Where the pointer is, and a dashed line from the point that follows it. */
function goal(paper, sight, points, data, state, unit) {
  const [x, y] = sight.see(points, data.dim * state.held), [toX, toY] = sight.see(state.goal, 0);
  paper.beginPath();
  paper.moveTo(x, y);
  paper.lineTo(toX, toY);
  paper.setLineDash([3 * unit, 4 * unit]);
  paper.strokeStyle = state.ink;
  paper.lineWidth = 1.4 * unit;
  paper.stroke();
  paper.setLineDash([]);
  paper.beginPath();
  paper.arc(toX, toY, 6 * unit, 0, 2 * Math.PI);
  paper.stroke();
}
