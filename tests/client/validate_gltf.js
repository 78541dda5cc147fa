// node validate_gltf.js VALIDATOR FILE.glb: prints the errors and warnings, one a line.
const [validator, file] = process.argv.slice(2);
const bytes = new Uint8Array(require('fs').readFileSync(file));
require(validator).validateBytes(bytes).then(({issues}) => {
  for (const issue of issues.messages) {
    if (issue.severity <= 1) console.log(`${issue.pointer}: ${issue.code}: ${issue.message}`);
  }
});
