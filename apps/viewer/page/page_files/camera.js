/** Where the sheet is seen from: `scale` pixels a mm, and the pixel at which the sheet's origin lies; y is up. */
export class Camera {
  constructor() {
    this.scale = 1;
    this.x = 0;
    this.y = 0;
    this.least = 0;
  }

  /**
   * All of a rectangle of the sheet in a window, with some air.
   *
   * @param {number[]} bounds mm
   * @param {number} wide pixels
   * @param {number} high pixels
   * @param {number} air pixels
   */
  fit(bounds, wide, high, air = 16) {
    const [x0, y0, x1, y1] = bounds;
    const room = [Math.max(1, wide - 2 * air), Math.max(1, high - 2 * air)];
    this.scale = Math.min(room[0] / Math.max(x1 - x0, 1e-6), room[1] / Math.max(y1 - y0, 1e-6));
    this.x = wide / 2 - (this.scale * (x0 + x1)) / 2;
    this.y = high / 2 + (this.scale * (y0 + y1)) / 2;
  }

  /**
   * Nearer (by more than 1) or farther; what lies under the pixel stays there.
   *
   * @param {number} by
   * @param {number} px
   * @param {number} py
   */
  zoom(by, px, py) {
    const scale = Math.min(2000, Math.max(this.least, this.scale * by));
    const real = scale / this.scale;
    this.x = px + (this.x - px) * real;
    this.y = py + (this.y - py) * real;
    this.scale = scale;
  }

  /**
   * @param {number} dx pixels
   * @param {number} dy pixels
   */
  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
  }

  /** @type {(px: number, py: number) => [number, number]} */
  toSheet(px, py) {
    return [(px - this.x) / this.scale, (this.y - py) / this.scale];
  }

  /** @type {(x: number, y: number) => [number, number]} */
  toScreen(x, y) {
    return [this.x + x * this.scale, this.y - y * this.scale];
  }

  /** @type {(other: Camera) => void} */
  like(other) {
    this.scale = other.scale;
    this.x = other.x;
    this.y = other.y;
    this.least = other.least;
  }

  /** @type {(other: Camera) => boolean} */
  same(other) {
    return this.scale === other.scale && this.x === other.x && this.y === other.y;
  }
}
