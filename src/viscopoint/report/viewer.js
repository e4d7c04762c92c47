// The interactive 3-D view: the surfaces of all runs at all snapshots, drawn by Plotly.
"use strict";
(() => {
  const FRAME = 700; // ms between pictures while playing
  const CAMERA = { eye: { x: 1.1, y: -1.9, z: 0.55 }, projection: { type: "orthographic" } };
  const CLOSER = 1.2; // per step of zoom
  const TURN = Math.PI / 24; // of an arrow key
  const NARROW = 640; // px, of a view that has its colour bar below
  const SLIM = 280; // px, of a panel without room for labels across
  // From above the viewer's left shoulder. Plotly takes the place within the camera's view, which is 1000 units deep
  // but two high; and takes the normals of faces this small for zero, unless told otherwise.
  const LIGHT = {
    lighting: { ambient: 0.75, diffuse: 0.45, specular: 0, facenormalsepsilon: 0, vertexnormalsepsilon: 0 },
    lightposition: { x: -500, y: 700, z: -2 },
  };

  class View {
    constructor(root) {
      this.root = root;
      this.plot = root.querySelector(".plot");
      this.scene = JSON.parse(root.querySelector("script").textContent);
      this.camera = CAMERA;
      this.zoom = 1;
      this.drawn = 0;
      this.ready = Promise.resolve();
      this.read();
      if (!View.supported()) {
        this.say("The 3-D view needs WebGL, which this browser does not offer. The figures show the same runs.");
        return;
      }
      root.classList.remove("idle");
      root.querySelector(".message").hidden = true;
      this.listen();
      this.draw();
    }

    static supported() {
      const canvas = document.createElement("canvas");
      return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
    }

    say(text) {
      const message = this.root.querySelector(".message");
      message.textContent = text;
      message.hidden = false;
      this.root.classList.add("idle");
    }

    control(name) {
      return this.root.querySelector(`[data-choice="${name}"]`);
    }

    action(name) {
      return this.root.querySelector(`[data-action="${name}"]`);
    }

    choices() {
      return [...this.root.querySelectorAll("[data-choice]")].map((control) => control.value).join();
    }

    read() {
      this.chosen = this.choices();
      const { materials, methods, times, fields } = this.scene;
      const number = (name) => Number(this.control(name).value);
      this.material = materials[number("material")];
      this.methods = number("method") < methods.length ? [methods[number("method")]] : methods;
      this.method = this.methods.length > 1 ? "side by side" : this.methods[0];
      this.fieldNumber = number("field");
      this.field = fields[this.fieldNumber].label;
      this.time = Math.min(number("time"), times.length - 1);
      const told = microseconds(times[this.time]);
      this.root.querySelector("output").textContent = told;
      this.control("time").setAttribute("aria-valuetext", told);
    }

    listen() {
      const form = this.root.querySelector("form");
      const follow = () => { if (this.choices() !== this.chosen) this.draw(); };
      form.addEventListener("submit", (event) => event.preventDefault());
      form.addEventListener("input", follow); // while the slider moves
      form.addEventListener("change", follow); // browsers differ in which of the two a list tells
      this.action("play").addEventListener("click", () => this.play());
      this.action("reset").addEventListener("click", () => this.look(CAMERA, 1));
      this.action("nearer").addEventListener("click", () => this.look(this.camera, this.zoom * CLOSER));
      this.action("farther").addEventListener("click", () => this.look(this.camera, this.zoom / CLOSER));
      this.plot.addEventListener("keydown", (event) => this.key(event));
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
      addEventListener("resize", () => this.draw());
    }

    // Draws the newest choice; what is chosen while a drawing goes on is drawn once after it.
    draw() {
      this.read();
      this.waiting = true;
      this.working ??= this.ready = this.work()
        .catch((error) => this.say(`The 3-D view could not be drawn (${error.message}).`))
        .finally(() => { this.working = undefined; });
      return this.ready;
    }

    async work() {
      while (this.waiting) {
        this.waiting = false;
        this.startAnewIfNarrowed();
        await Plotly.react(this.plot, this.traces(), this.layout(), {
          displaylogo: false, displayModeBar: false, responsive: true, scrollZoom: false,
        });
        this.followCamera();
        await nextPicture();
        this.drawn += 1;
      }
    }

    // A colour bar that moves from beside the panels to below them would leave its old margins behind.
    startAnewIfNarrowed() {
      const narrow = this.plot.clientWidth < NARROW;
      if (this.narrow !== undefined && this.narrow !== narrow) {
        Plotly.purge(this.plot);
        this.following = false;
      }
      this.narrow = narrow;
    }

    shape(method) {
      return this.scene.shapes.find((shape) => shape.material === this.material && shape.method === method);
    }

    traces() {
      return this.methods.flatMap((method, panel) => {
        const shape = this.shape(method);
        return shape ? [this.body(shape, sceneName(panel)), this.wall(shape.wall, sceneName(panel))] : [];
      });
    }

    body(shape, scene) {
      const { unit } = this.scene.fields[this.fieldNumber];
      return {
        type: "mesh3d", scene, coloraxis: "coloraxis", flatshading: shape.edge > 0,
        ...viscopointSurface(shape, shape.shown[this.time], this.fieldNumber),
        ...LIGHT,
        hovertemplate: `${this.field} %{intensity:.3g} ${unit}<br>x %{x:.2f}, y %{y:.2f}, z %{z:.2f} mm<extra></extra>`,
      };
    }

    wall(height, scene) {
      const [[left, right], [front, back]] = this.scene.box;
      return {
        type: "mesh3d", scene, x: [left, right, right, left], y: [front, front, back, back],
        z: [height, height, height, height], i: [0, 0], j: [1, 2], k: [2, 3],
        color: colour("--wall"), opacity: 0.35, hoverinfo: "skip", flatshading: true,
        lighting: { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 },
      };
    }

    layout() {
      const { label, unit, range } = this.scene.fields[this.fieldNumber];
      const bar = this.narrow
        ? { orientation: "h", x: 0.5, xanchor: "center", y: 0, yanchor: "top", len: 0.9, thickness: 12 }
        : { x: 1.0, xanchor: "left", len: 0.8, thickness: 16 };
      const layout = {
        margin: this.narrow ? { l: 0, r: 0, t: 40, b: 70 } : { l: 0, r: 100, t: 40, b: 0 },
        paper_bgcolor: "rgba(0,0,0,0)", showlegend: false,
        font: { family: getComputedStyle(document.body).fontFamily, size: 13, color: colour("--ink") },
        coloraxis: {
          colorscale: this.scene.colours, cmin: range[0], cmax: range[1],
          colorbar: { title: { text: `${label} [${unit}]`, side: this.narrow ? "top" : "right" }, ...bar },
        },
        annotations: [],
      };
      const count = this.methods.length;
      this.methods.forEach((method, panel) => {
        layout[sceneName(panel)] = this.panel([panel / count, (panel + 1) / count]);
        layout.annotations.push({
          text: this.heading(method), x: (panel + 0.5) / count, xanchor: "center", y: 1, yanchor: "bottom",
          xref: "paper", yref: "paper", showarrow: false, font: { size: 15 },
        });
      });
      return layout;
    }

    isSlim() {
      return this.plot.clientWidth / this.methods.length < SLIM;
    }

    panel(domain) {
      const slim = this.isSlim();
      const axis = (side) => ({
        title: { text: "" }, range: this.scene.box[side], autorange: false, tickfont: { size: slim ? 11 : 12 },
        gridcolor: colour("--line"), zeroline: false, showbackground: false, showspikes: false,
      });
      const across = (letter, side) => ({
        ...axis(side), title: { text: slim ? "" : `${letter} [mm]` }, showticklabels: !slim,
        tickvals: besideMiddle(this.scene.box[side]),
      });
      const up = { nticks: slim ? 5 : 8, tickprefix: slim ? "" : "z = ", ticksuffix: slim ? "" : " mm" };
      return {
        domain: { x: domain, y: [0, 1] }, camera: structuredClone(this.camera), dragmode: "turntable",
        hovermode: "closest", aspectmode: "manual", aspectratio: this.proportions(),
        xaxis: across("x", 0), yaxis: across("y", 1),
        zaxis: { ...axis(2), ...up, showtickprefix: "last", showticksuffix: "last" },
      };
    }

    // Sizes in the picture, the same scale along all axes: a panel is two units high, labels included.
    proportions() {
      const [x, y, z] = this.scene.box.map(([low, high]) => high - low);
      const wide = (2 * this.plot.clientWidth) / this.methods.length / this.plot.clientHeight;
      const within = (this.isSlim() ? 1 : 0.75) * wide;
      const scale = this.zoom * Math.min(1.85 / (z + 0.25 * Math.hypot(x, y)), within / Math.hypot(x, y));
      return { x: x * scale, y: y * scale, z: z * scale };
    }

    heading(method) {
      const shape = this.shape(method);
      if (!shape) return `${plain(method)}: no run`;
      const [asked, shown] = [this.scene.times[this.time], shape.times[shape.shown[this.time]]];
      const same = Math.abs(shown - asked) <= 1e-6 * this.scene.times.at(-1);
      return `${plain(method)}, ${microseconds(shown)}${same ? "" : ` (none at ${microseconds(asked)})`}`;
    }

    // --- camera: one for all panels, whatever is switched ---

    followCamera() {
      if (this.following) return;
      this.following = true;
      const follow = (change) => {
        const name = Object.keys(change).find((key) => key.endsWith(".camera"));
        if (name) this.look(change[name], this.zoom, true);
      };
      this.plot.on("plotly_relayouting", follow);
      this.plot.on("plotly_relayout", follow);
    }

    // Plotly tells of the cameras that are set here too.
    look(camera, zoom = this.zoom, fromPlotly = false) {
      const same = JSON.stringify(camera) === JSON.stringify(this.camera);
      Object.assign(this, { camera, zoom });
      if (fromPlotly && (same || this.methods.length < 2)) return;
      if (this.working) {
        this.waiting = true; // the next drawing takes the camera
        return;
      }
      const change = {};
      this.methods.forEach((_, panel) => {
        change[`${sceneName(panel)}.camera`] = structuredClone(camera); // Plotly keeps and changes it
        if (!fromPlotly) change[`${sceneName(panel)}.aspectratio`] = this.proportions();
      });
      this.ready = Plotly.relayout(this.plot, change).then(nextPicture);
    }

    turn(around, up) {
      const { x, y, z } = this.camera.eye;
      const distance = Math.hypot(x, y, z);
      const azimuth = Math.atan2(y, x) + around;
      const height = Math.max(-1.5, Math.min(1.5, Math.asin(z / distance) + up));
      const across = distance * Math.cos(height);
      const eye = { x: across * Math.cos(azimuth), y: across * Math.sin(azimuth), z: distance * Math.sin(height) };
      this.look({ ...this.camera, eye });
    }

    key(event) {
      const moves = {
        ArrowLeft: () => this.turn(-TURN, 0),
        ArrowRight: () => this.turn(TURN, 0),
        ArrowUp: () => this.turn(0, TURN),
        ArrowDown: () => this.turn(0, -TURN),
        "+": () => this.look(this.camera, this.zoom * CLOSER),
        "-": () => this.look(this.camera, this.zoom / CLOSER),
      };
      if (!(event.key in moves) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      moves[event.key]();
    }

    // --- time ---

    async play() {
      const button = this.action("play");
      const mine = this.playing ? undefined : {}; // a loop ends, too, where another was started since
      this.playing = mine;
      button.textContent = mine ? "Pause" : "Play";
      while (mine && this.playing === mine) {
        const slider = this.control("time");
        slider.value = (Number(slider.value) + 1) % this.scene.times.length;
        await Promise.all([this.draw(), new Promise((done) => setTimeout(done, FRAME))]);
      }
    }
  }

  function sceneName(panel) {
    return panel ? `scene${panel + 1}` : "scene";
  }

  // Two round places, so that the axis title finds room between them.
  function besideMiddle([low, high]) {
    const half = (high - low) / 2;
    const power = 10 ** Math.floor(Math.log10(half));
    const step = power * [1, 2, 5].findLast((digit) => digit * power <= half);
    const middle = Math.round((low + high) / 2 / step) * step;
    return [middle - step, middle + step];
  }

  function microseconds(time) {
    return `${Number(time.toPrecision(4))} µs`;
  }

  // Plotly reads some tags in its texts.
  function plain(text) {
    return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
  }

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  function nextPicture() {
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }

  // For scripts and tests: what the (first) view shows; `ready` is kept once it is drawn.
  window.viscopointViews = [...document.querySelectorAll(".view")].map((root) => new View(root));
  window.viscopointView = window.viscopointViews[0];
})();
