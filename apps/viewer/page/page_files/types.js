/**
 * The data of the page, `kerfwise-page/1`: mm, s, y up. Rows are x, y, bulge of one vertex after the other.
 *
 * @typedef {[number, number]} Point
 * @typedef {"outer" | "hole" | "mark" | "slit" | "scrap"} Kind
 *
 * @typedef {object} Contour
 * @property {string} id
 * @property {number} part - number of its part, -1 for none
 * @property {Kind} kind
 * @property {number[]} rows
 * @property {boolean} closed
 * @property {string} [drawn] - what the drawing says of it: layer, colour, line type, block, text
 * @property {string} [colour] - that it is drawn in
 * @property {string} [text] - the writing that it is a stroke of
 *
 * @typedef {object} NestData
 * @property {string} file
 * @property {string} sha256
 * @property {number[]} bounds - xmin, ymin, xmax, ymax of the sheet
 * @property {number[][]} sheet - rows of its outline, then of its holes
 * @property {string[]} parts
 * @property {Contour[]} contours
 * @property {number[][]} left_out - rows of holes that are not cut
 * @property {string[]} notes
 *
 * @typedef {object} CutData
 * @property {number} contour
 * @property {number} zone - 0 for none
 * @property {string} direction
 * @property {Point} entry
 * @property {number} from_s
 * @property {number} to_s
 * @property {number} stand_s - how long the torch stands at first, to pierce
 * @property {number} wait_s - how long it waits before, off
 * @property {number} length_mm
 * @property {string[]} because
 * @property {boolean} linked
 * @property {number} [torch] - from 2 on: it is cut with the last cut of the first torch before it, by the same motion
 * @property {string[]} excused - rules that the plan could not keep here
 * @property {number[][]} tabs - x, y, width
 * @property {number[]} path - rows of the torch's way
 * @property {Point[]} unlit - stretches of the way, mm from its start, without the torch
 * @property {number[]} slow - how many times slower each line or arc of the way is; empty where none is
 *
 * @typedef {{contour: number, at: Point, before: number, from_s: number, to_s: number}} PierceData
 * @typedef {{contours: string[], text: string, why?: string}} Place
 * @typedef {{rule: string, text: string}} Told
 *
 * @typedef {object} RuleData
 * @property {string} id
 * @property {string} sentence
 * @property {string} strength
 * @property {string} verdict
 * @property {number} cost_mm
 * @property {string} unjudged
 * @property {Place[]} breaches
 * @property {Place[]} excused
 *
 * @typedef {{contour: string, place: number, rule: string, text: string}} Hold
 * @typedef {{nearest: Hold[], more: number}} Holds
 * @typedef {{at: Point, direction: string, text: string, cost?: string}} EntryWay
 *
 * @typedef {object} Why
 * @property {boolean} full - whether other entries and places were tried
 * @property {number} place
 * @property {number} of
 * @property {number} zone
 * @property {string} after
 * @property {string} before
 * @property {string[]} said
 * @property {Holds} earlier
 * @property {Holds} later
 * @property {Told[]} also
 * @property {{rule: string, text: string, kept: boolean, price_mm: number}[]} heat
 * @property {null | {used: EntryWay, one_way_by: string[], lawful: EntryWay[],
 *   unlawful: {rule: string, text: string, ways: EntryWay[], more: number}[]}} entry
 * @property {{label: string, place: number, together: string[], cost: string, breaks: Told[]}[]} moves
 * @property {string[]} notes
 *
 * @typedef {object} HeatData
 * @property {string} model
 * @property {number[]} at_s
 * @property {number} wide
 * @property {number} high
 * @property {number} left_mm
 * @property {number} bottom_mm
 * @property {number} square_mm
 * @property {number} ambient_c
 * @property {number} limit_c
 * @property {number} top_c
 * @property {number} peak_c
 * @property {number} overheats
 * @property {string} frames - deflated bytes in base64: frame after frame, rows from the bottom up
 *
 * @typedef {object} BentLine
 * @property {string} name - id of its contour, "" for the sheet's edge
 * @property {string} kind
 * @property {number[]} xy - as it is drawn, mm
 * @property {number[][]} moved - in each frame, µm
 * @property {number | null} cut_s - when it is cut
 * @property {number[] | null} cold - how far it is off when all is cold, µm
 *
 * @typedef {object} BentData - how the sheet moves while it is cut
 * @property {number[]} at_s
 * @property {number} times - so many times as far metal is drawn away
 * @property {number} times_cold - the same of parts that are cold
 * @property {BentLine[]} lines
 *
 * @typedef {{text: string, lines: number[][]}} NcData
 *
 * @typedef {{kind: "kept" | "kept but for" | "broken", count: number, short: string, told: string, for_operator: string}} StateData
 *
 * @typedef {object} SideData
 * @property {string} name
 * @property {string} profile
 * @property {number} kerf_mm
 * @property {Point} home
 * @property {number} made - cuts made before a stop
 * @property {number} end_s
 * @property {{cut_mm: number, idle_mm: number, pierces: number, status: string, gap: number | null,
 *   light_gap: number | null, proof?: string, cost?: string | null}} figures
 * @property {string[]} said
 * @property {boolean} ok - whether it may be cut: `state` says whether every hard rule holds
 * @property {StateData} state
 * @property {boolean} [unchecked] - whether there is no program yet, and the plan alone was judged
 * @property {CutData[]} cuts
 * @property {PierceData[]} pierces
 * @property {number[]} already
 * @property {RuleData[]} rules
 * @property {string[]} [warnings]
 * @property {{rule: string, contours: string[], why: string}[]} dropped
 * @property {{contour: string, why: string}[]} left_out
 * @property {Record<string, Why>} why
 * @property {HeatData | null} heat
 * @property {NcData | null} nc
 *
 * @typedef {object} ComparisonData
 * @property {string[]} sides
 * @property {string[][]} figures
 * @property {string[][]} rules
 * @property {string[]} proofs
 * @property {string} summary
 * @property {{contour: number, a: number | null, b: number | null, told: string}[]} changed
 *
 * @typedef {object} PageData
 * @property {string} format
 * @property {string} [language] - that the page was made for; else the browser's
 * @property {string} title
 * @property {string} caption
 * @property {NestData} nest
 * @property {number[]} alert
 * @property {SideData[]} sides
 * @property {ComparisonData | null} comparison
 *
 * @typedef {object} Source
 * @property {() => Promise<PageData>} page
 * @property {(side: number, contour: string) => Promise<Why | null>} why
 * @property {(side: number) => Promise<HeatData | null>} heat
 * @property {boolean} [heatIsMade] - whether heat is simulated when it is asked for: so that is not done unasked
 * @property {(side: number) => Promise<NcData | null>} nc
 * @property {(side: number) => Promise<BentData | null>} [bent] - simulated when it is asked for; left out where that cannot be
 */

