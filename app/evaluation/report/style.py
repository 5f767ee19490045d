"""How the report looks."""

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1b1b1b; background: #fff; max-width: 1180px; margin: 2em auto;
  padding: 0 1.2em }
h1 { font-size: 1.6em; overflow-wrap: anywhere } h2 { margin-top: 2em; border-bottom: 1px solid #ccc }
h3 { margin-bottom: .3em } h4 { margin: 1em 0 .3em }
p { max-width: 75ch } .note { background: #fff4d6; padding: .4em .8em } .small, footer { color: #555; font-size: .87em }
.wide { overflow-x: auto } table { border-collapse: collapse; font-variant-numeric: tabular-nums }
th, td { padding: .25em .8em; text-align: right; border-bottom: 1px solid #e4e4e4; vertical-align: top }
th { font-weight: 600; max-width: 16em; overflow-wrap: break-word }
td { max-width: 26em } td:first-child { white-space: nowrap }
th:first-child, td:first-child, .avatars :is(th, td):is(:nth-child(6), :nth-child(8)) { text-align: left }
td em { color: #777 } td i { display: inline-block; width: .8em; height: .8em; margin-right: .5em; border-radius: 50% }
.curves { display: grid; grid-template-columns: repeat(auto-fill, minmax(380px, 1fr)); gap: .6em }
svg { width: 100%; height: auto } svg text { font-size: 12px; fill: #444 } svg .name { font-weight: 600 }
svg .tick { text-anchor: end } svg .grid { stroke: #e4e4e4 }
figure { margin: 0 } figure img { width: 100%; vertical-align: top }
figcaption { font-size: .87em; color: #555 }
.compared { display: grid; grid-template-columns: repeat(auto-fill, minmax(185px, 1fr)); gap: .5em }
.heat { display: inline-block; width: 7em; height: .8em; vertical-align: middle;
  background: linear-gradient(90deg, #000, #f00 33%, #ff0 67%, #fff); border: 1px solid #999 }
.strip td { padding: 2px } .strip img { display: block; max-width: 100% } .strip th { vertical-align: middle }
.met { color: #00663f; font-weight: 600; white-space: nowrap } .met::after { content: "\\2713" }
.missed { color: #a8320a }
.scene { width: 100% } .scene th { width: 11em } .scene img { width: 100% }
.tight { font-size: .93em } .tight :is(th, td) { padding: .25em .45em }
.steady :is(th, td):nth-child(5) { text-align: left; max-width: 34em } .key td { border: 0; padding: 0 1em 0 0 }
.worst { display: flex; flex-wrap: wrap; gap: .6em } .worst figure { width: 112px } .worst img { width: 100% }
.worst figcaption { font-size: .75em; line-height: 1.3 }
summary { cursor: pointer; margin: 1em 0 }
@media (max-width: 560px) { .curves { grid-template-columns: 1fr } }
""".strip()
