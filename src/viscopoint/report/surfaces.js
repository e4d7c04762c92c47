// From the packed numbers of a run's snapshot to vertices, triangles and a value at each vertex, see surfaces.py.
"use strict";
const viscopointSurface = (() => {
  const MISSING = 65535; // the code of a value that is not there, see packing.py
  const CUBE = [ // corners of its triangles: bit 0 for x, 1 for y, 2 for z
    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
  ];

  function bytes(text) {
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  }

  function unpacked({ low, step, codes }) {
    const whole = new Uint16Array(bytes(codes).buffer);
    return Float32Array.from(whole, (code) => (code === MISSING ? NaN : low + step * code));
  }

  function elementSurface(faces, [x, y, z], values) {
    const i = [], j = [], k = [];
    for (let f = 0; f < faces.length; f += 4) {
      const [a, b, c, d] = faces.subarray(f, f + 4);
      if (Number.isNaN(x[a] + x[b] + x[c] + x[d])) continue; // beyond what is shown
      i.push(a, a);
      j.push(b, c);
      k.push(c, d);
    }
    return { x: x.map(orZero), y: y.map(orZero), z: z.map(orZero), i, j, k, intensity: values.map(orZero) };
  }

  function orZero(value) {
    return Number.isNaN(value) ? 0 : value; // no triangle has that vertex
  }

  function cubes(edge, places, values) {
    const there = [...values.keys()].filter((p) => !Number.isNaN(values[p]));
    const corners = (place, bit) =>
      Float32Array.from({ length: 8 * there.length }, (_, v) => place[there[v >> 3]] + edge * (((v >> bit) & 1) - 0.5));
    const triangles = (corner) =>
      Uint32Array.from({ length: 12 * there.length }, (_, t) => 8 * Math.floor(t / 12) + CUBE[3 * (t % 12) + corner]);
    return {
      x: corners(places[0], 0), y: corners(places[1], 1), z: corners(places[2], 2),
      i: triangles(0), j: triangles(1), k: triangles(2),
      intensity: Float32Array.from({ length: 8 * there.length }, (_, v) => values[there[v >> 3]]),
    };
  }

  return (shape, number, field) => {
    const arrays = shape.arrays[number];
    const places = arrays.slice(0, 3).map(unpacked);
    const values = unpacked(arrays[3 + field]);
    if (shape.edge > 0) return cubes(shape.edge, places, values);
    return elementSurface(new Uint32Array(bytes(shape.faces[shape.facesAt[number]]).buffer), places, values);
  };
})();
