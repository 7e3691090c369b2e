// What is normal of each column: of an episode, and of all. Numbers are of what is written, float32 as float32.

const QUANTILES = { q01: 0.01, q10: 0.1, q50: 0.5, q90: 0.9, q99: 0.99 };
export const STATS = ['min', 'max', 'mean', 'std', ...Object.keys(QUANTILES)];
// Of so many frames, evenly over all, quantiles of the whole data set are made.
const KEPT_FRAMES = 100_000;

/** The quantile of sorted numbers, between two of them as numpy does it. */
export function quantile(sorted, share) {
  const at = share * (sorted.length - 1);
  const low = Math.floor(at);
  const high = Math.min(low + 1, sorted.length - 1);
  return sorted[low] + (sorted[high] - sorted[low]) * (at - low);
}

function quantilesOf(values, width) {
  const out = Object.fromEntries(Object.keys(QUANTILES).map((key) => [key, new Array(width)]));
  const count = values.length / width;
  const one = new Float64Array(count);
  for (let i = 0; i < width; ++i) {
    for (let row = 0; row < count; ++row) one[row] = values[row * width + i];
    one.sort();
    for (const [key, share] of Object.entries(QUANTILES)) out[key][i] = quantile(one, share);
  }
  return out;
}

/** {min, max, mean, std, q01 ... q99: `width` numbers each, count} of rows of `width` numbers. */
export function statsOf(values, width) {
  const count = values.length / width;
  const out = { min: new Array(width).fill(Infinity), max: new Array(width).fill(-Infinity), mean: new Array(width).fill(0), std: new Array(width).fill(0) };
  for (let k = 0; k < values.length; ++k) {
    const i = k % width;
    if (values[k] < out.min[i]) out.min[i] = values[k];
    if (values[k] > out.max[i]) out.max[i] = values[k];
    out.mean[i] += values[k] / count;
  }
  for (let k = 0; k < values.length; ++k) out.std[k % width] += (values[k] - out.mean[k % width]) ** 2 / count;
  out.std = out.std.map(Math.sqrt);
  return { ...out, ...quantilesOf(values, width), count };
}

/** Those of several episodes as of one. Quantiles come from frames, as those of episodes do not add up. */
export class TotalStats {
  columns = new Map();
  frames = 0;
  stride = 1;

  /** `columns`: key -> {width, values}; `stats`: key -> what statsOf says of it. */
  add(length, columns, stats) {
    for (const [key, { width, values }] of columns) {
      const total = this.columns.get(key) ?? { width, count: 0, parts: [], kept: [] };
      this.columns.set(key, total);
      total.parts.push(stats.get(key));
      total.count += length;
      for (let row = 0; row < length; ++row) {
        if ((this.frames + row) % this.stride === 0) total.kept.push(values.slice(row * width, (row + 1) * width));
      }
    }
    this.frames += length;
    while (Math.ceil(this.frames / this.stride) > KEPT_FRAMES) this.thin();
  }

  thin() {
    this.stride *= 2;
    for (const total of this.columns.values()) total.kept = total.kept.filter((_, i) => i % 2 === 0);
  }

  /** key -> stats */
  result() {
    return new Map([...this.columns].map(([key, total]) => [key, this.of(total)]));
  }

  of({ width, count, parts, kept }) {
    const each = (what) => Array.from({ length: width }, (_, i) => what(i));
    const sum = (what) => parts.reduce((so, part) => so + part.count * what(part), 0) / count;
    const mean = each((i) => sum((part) => part.mean[i]));
    const all = new Float64Array(kept.length * width);
    kept.forEach((row, i) => all.set(row, i * width));
    return {
      min: each((i) => parts.reduce((so, part) => Math.min(so, part.min[i]), Infinity)),
      max: each((i) => parts.reduce((so, part) => Math.max(so, part.max[i]), -Infinity)),
      mean,
      std: each((i) => Math.sqrt(sum((part) => part.std[i] ** 2 + (part.mean[i] - mean[i]) ** 2))),
      ...quantilesOf(all, width),
      count,
    };
  }
}
