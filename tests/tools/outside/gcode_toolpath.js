// Prints what gcode-toolpath makes of the program on standard input: one JSON row a move.
const Toolpath = require('gcode-toolpath');
const rows = [];
const xy = (v) => [v.x, v.y];
const toolpath = new Toolpath({
  addLine: (modal, v1, v2) => rows.push([modal.motion, xy(v1), xy(v2)]),
  addArcCurve: (modal, v1, v2, v0) => rows.push([modal.motion, xy(v1), xy(v2), xy(v0)]),
});
let text = '';
process.stdin.on('data', (chunk) => { text += chunk; });
process.stdin.on('end', () => {
  toolpath.loadFromString(text, (error) => {
    if (error) { console.error(String(error)); process.exit(1); }
    process.stdout.write(JSON.stringify(rows));
  });
});
