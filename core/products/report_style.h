// The look of the report.
#pragma once

namespace tiltmap {

inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark; --paper: #f5f6f8; --card: #ffffff; --line: #e1e4ea; --text: #181c24; --dim: #5c6472;
  --accent: #0b63c5; --warn-back: #fff6e0; --warn-line: #e0a100; --warn-text: #5c4300; --bad: #b3261e; --zebra: #fafbfc; }
@media (prefers-color-scheme: dark) { :root { --paper: #0f1218; --card: #161a22; --line: #2a303c; --text: #eceff4;
  --dim: #9ea7b5; --accent: #7db4ff; --warn-back: #2b2410; --warn-line: #c9971c; --warn-text: #f4dfa4; --bad: #ff9d94;
  --zebra: #191e27; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--text);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 40px 24px 64px; }
header { margin-bottom: 28px; }
h1 { font-size: 30px; line-height: 1.2; font-weight: 650; letter-spacing: -0.01em; margin: 0 0 6px; overflow-wrap: anywhere; }
h2 { font-size: 19px; line-height: 1.3; font-weight: 650; margin: 44px 0 12px; }
h3 { font-size: 15px; font-weight: 600; margin: 24px 0 8px; }
p { margin: 0 0 12px; max-width: 74ch; }
.dim { color: var(--dim); }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 10px; overflow: hidden; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin: 0 0 24px; }
.figures div { padding: 14px 16px; }
.figures dt { color: var(--dim); font-size: 13px; }
.figures dd { margin: 2px 0 0; font-size: 22px; line-height: 1.25; font-weight: 600; font-variant-numeric: tabular-nums; }
.figures small { font-size: 14px; font-weight: 400; color: var(--dim); }
.warnings { background: var(--warn-back); border: 1px solid var(--warn-line); border-left-width: 5px; border-radius: 10px;
  color: var(--warn-text); padding: 14px 20px; margin: 0 0 24px; }
.warnings h2 { font-size: 16px; margin: 0 0 4px; }
.warnings ul { margin: 0; padding-left: 20px; }
.warnings li { overflow-wrap: anywhere; }
figure { margin: 0; overflow: hidden; }
figure img { display: block; width: 100%; height: auto; }
figcaption { padding: 10px 16px; color: var(--dim); font-size: 13px; border-top: 1px solid var(--line); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { padding: 7px 14px; text-align: left; vertical-align: baseline; }
th { font-weight: 600; font-size: 13px; color: var(--dim); border-bottom: 1px solid var(--line); white-space: nowrap; }
th small { font-weight: 400; font-size: inherit; }
tbody tr:nth-child(even) { background: var(--zebra); }
tbody tr + tr td { border-top: 1px solid var(--line); }
.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.bad { color: var(--bad); font-weight: 600; }
td code { font: 13px ui-monospace, "DejaVu Sans Mono", monospace; }
details { margin: 0 0 12px; }
summary { cursor: pointer; padding: 11px 16px; font-weight: 600; }
details[open] summary { border-bottom: 1px solid var(--line); }
a { color: var(--accent); }
ul.files { padding: 12px 16px 12px 34px; margin: 0; }
footer { margin-top: 44px; color: var(--dim); font-size: 13px; }
@media (max-width: 560px) { main { padding: 24px 14px 40px; } h1 { font-size: 24px; } th, td { padding: 6px 10px; } }
@media print { :root { color-scheme: light; --paper: #ffffff; --card: #ffffff; --line: #c9ced8; --text: #000000; --dim: #444b57;
  --accent: #000000; --warn-back: #ffffff; --warn-text: #000000; --bad: #8c1d18; --zebra: #ffffff; }
  body { font-size: 10pt; } main { max-width: none; padding: 0; } table { font-size: 9pt; } th, td { padding: 3px 8px; }
  h2, h3 { break-after: avoid; } tr, figure, .figures div, .warnings { break-inside: avoid; } thead { display: table-header-group; }
  .scroll { overflow: visible; } @page { margin: 16mm; } }
)css";

}  // namespace tiltmap
