/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every page has: its style, its head and its end, and text made harmless. */
#include "page/page.h"
#include "core/json_writer.h"

static const char style[] =
    ":root{--ink:#16202a;--soft:#5b6875;--line:#dfe4e9;--ground:#f4f6f8;--good:#12804a;"
    "--bad:#c62828;--open:#a86400;--bump:#d95f02;--blue:#1f6fd0}\n"
    "*{box-sizing:border-box}body{margin:0;background:var(--ground);color:var(--ink);"
    "font:15px/1.5 system-ui,-apple-system,\"Segoe UI\",Roboto,\"Helvetica Neue\",Arial,"
    "\"DejaVu Sans\",sans-serif}\n"
    "main{max-width:1120px;margin:0 auto;padding:20px 16px 48px}\n"
    "section{background:#fff;border:1px solid var(--line);border-radius:12px;padding:22px 24px;"
    "margin-bottom:24px}\n"
    "header{display:flex;flex-wrap:wrap;gap:6px 18px;align-items:center;margin-bottom:14px}\n"
    "h1{font-size:24px;line-height:1.2;margin:0}h2{font-size:17px;margin:28px 0 8px}\n"
    "header p{margin:0;color:var(--soft);overflow-wrap:anywhere}\n"
    ".verdict{font-weight:700;font-size:17px;line-height:1.3;padding:5px "
    "16px;border-radius:8px;color:#fff;background:var(--soft);white-space:nowrap}"
    ".verdict.pass{background:var(--good)}.verdict.fail{background:var(--bad)}"
    ".verdict.cannot_tell,.verdict.not_measured{background:var(--open)}"
    /* A verdict is a sign and a word before it is a colour. */
    ".verdict.pass::before{content:\"✓ \"}.verdict.fail::before{content:\"✗ \"}"
    ".verdict.cannot_tell::before{content:\"? \"}.verdict.not_measured::before{content:\"⊘ \"}"
    ".tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(134px,1fr));gap:10px;"
    "margin:0 0 16px}.tiles div{background:var(--ground);border-radius:8px;padding:9px 9px}"
    ".tiles dt{font-size:12.5px;color:var(--soft)}.tiles dd{margin:0;font-size:15px;"
    "font-weight:600;font-variant-numeric:tabular-nums;white-space:nowrap}"
    ".tiles "
    "small{display:block;font-size:12.5px;font-weight:400;color:var(--soft);white-space:normal}\n"
    "figure{margin:0}figcaption{font-size:13px;color:var(--soft);margin-top:6px}\n"
    ".picture{display:block;width:auto;max-width:100%;height:auto;max-height:600px;margin:0 "
    "auto;border-radius:8px;background:#"
    "20262c}"
    ".picture text{font-family:inherit;font-weight:600;paint-order:stroke;stroke:#10151a;"
    "stroke-width:4px;stroke-linejoin:round}\n"
    ".scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:13.5px;"
    "font-variant-numeric:tabular-nums}th,td{padding:5px 10px;text-align:right;white-space:nowrap;"
    "border-bottom:1px solid "
    "var(--line)}th{font-weight:600;color:var(--soft);vertical-align:bottom}"
    "th:first-child,td:first-child{text-align:left}td.words{text-align:left;white-space:normal}td."
    "words:not(:empty){min-width:150px}"
    "td "
    "i{display:block;font-style:normal;font-weight:400;color:var(--soft);font-size:11.5px;line-"
    "height:1.2}"
    "td.fail{background:#fdeaea;color:var(--bad);font-weight:600}"
    "td.cannot_tell{background:#fff4df;color:var(--open);font-weight:600}"
    "td.fail::before{content:\"✗ \"}td.cannot_tell::before{content:\"? \"}"
    "td.pass{background:#edf7f1}tr.limits td{color:var(--soft);font-size:12.5px}\n"
    ".corrected{margin:0 0 14px;padding:9px 14px;border-left:4px solid var(--blue);background:"
    "#eaf2fc;border-radius:0 8px 8px 0;overflow-wrap:anywhere}\n"
    ".reasons{margin:-6px 0 10px;color:var(--soft)}.reasons b{color:var(--ink)}\n"
    "ul.flags{margin:0 0 14px;padding:10px 14px 10px 32px;background:#fff8e8;border-radius:8px}\n"
    ".plot{display:block;width:100%;height:auto;font-size:14px}.plot text{fill:var(--ink)}"
    ".plot .x,.plot .title{text-anchor:middle}.plot .y{text-anchor:end}.plot .title{fill:"
    "var(--soft)}.plot .bump{fill:var(--bump);font-weight:600}.grid{stroke:#e6eaee}"
    ".zero{stroke:#8a96a1}.band{fill:#fdf0e6}.plot path{fill:none}.land{stroke:var(--blue)}"
    ".arc{stroke:var(--bump)}path.s1{stroke:var(--bump);stroke-width:2}circle.s1{fill:var(--bump)}"
    "path.s2{stroke:var(--blue);stroke-width:2}circle.s2{fill:#fff;stroke:var(--blue);"
    "stroke-width:2.5}path.doubt{stroke-width:1;stroke-dasharray:4 3}\n"
    "dl.facts{display:grid;grid-template-columns:max-content 1fr;gap:2px 16px;margin:0;"
    "font-size:13.5px}dl.facts dt{color:var(--soft)}dl.facts dd{margin:0;overflow-wrap:anywhere}\n"
    ".note{font-size:13.5px;color:var(--soft);max-width:75ch}\n"
    "@media(max-width:600px){main{padding:8px}section{padding:14px;border-radius:8px}"
    ".tiles{grid-template-columns:1fr 1fr}.tiles dd{font-size:16px;white-space:normal}"
    ".plot{font-size:20px}dl.facts{grid-template-columns:1fr}dl.facts dd{margin-bottom:6px}}\n";

/* Of a verdict: the section that it is of, what is told, what to do. */
static const char judged_style[] =
    "section.judged{border-left:10px solid var(--line)}section.judged.pass{border-left-color:"
    "var(--good)}section.judged.fail{border-left-color:var(--bad)}section.judged.cannot_tell,"
    "section.judged.not_measured{border-left-color:var(--open)}.why td{vertical-align:top}.why "
    "td.words{min-width:0}.why td:last-child{width:46%}"
    "tr.unfitted td{background:repeating-linear-gradient(135deg,#fff 0 6px,#f1f3f5 6px 12px)}"
    ".why a{color:#0b4f9e}.limits-of{stroke:var(--bad);stroke-width:1.5;stroke-dasharray:7 4}"
    ".inside{fill:#edf7f1}.plot .beyond-limit{stroke:var(--bad);stroke-width:2.5;fill:none}"
    ".plot "
    ".told{font-weight:600;fill:var(--bad);paint-order:stroke;stroke:#fff;stroke-width:4px}.plot "
    ".open{fill:var(--open)}\n"
    ".next{margin:0 0 16px;padding:10px 16px;border-left:6px solid var(--open);background:#fff8e8;"
    "border-radius:0 8px 8px 0;font-size:16px;max-width:95ch}.next code{display:block;margin:6px 0 "
    "0;"
    "padding:5px 10px;background:#fff;border-radius:6px;font-size:13.5px;user-select:all}\n";

/* On paper a page runs on: nothing begins a sheet of its own, a heading keeps what it is of, and
 * no picture is so tall that it leaves half a sheet empty. */
static const char print_style[] =
    "@media print{@page{margin:14mm}body{background:#fff;font-size:10pt;"
    "-webkit-print-color-adjust:exact;print-color-adjust:exact}main{max-width:none;padding:0}"
    "section{border:0;border-radius:0;padding:0;margin:0 0 18pt}"
    "section.judged{padding-left:8px;"
    "-webkit-box-decoration-break:clone;box-decoration-break:clone}"
    "h1,h2,h3,summary,header,figcaption:first-child,h2+.note{break-after:avoid}"
    "figure,tr,header,.tiles,.reasons,.next,ul.flags,.corrected,dl.facts,.panels figure{"
    "break-inside:avoid}p,li{orphans:3;widows:3}thead{display:table-header-group}"
    ".picture{max-height:105mm}.scroll{overflow:visible}table{font-size:7.6pt}th,td{padding:3px "
    "4px}"
    "td i{font-size:6.6pt}td.words:not(:empty){min-width:18mm}.tiles{grid-template-columns:repeat("
    "auto-fit,minmax(23mm,1fr));gap:5px}.tiles div{padding:5px 6px}.tiles "
    "dd{font-size:9pt;white-space:normal}.tiles dt,.tiles small{font-size:7.5pt}"
    ".note{max-width:none}"
    ".panels{grid-template-columns:1fr 1fr}}\n";

/* Plots side by side, effects, contours. */
static const char plot_style[] =
    ".panels{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(400px,100%),1fr));gap:"
    "14px 22px}"
    ".panels figure{break-inside:avoid}.panels h3{font-size:14px;margin:4px 0 0;font-weight:600}"
    ".plot .start{text-anchor:start}.plot .soft{fill:var(--soft)}"
    ".plot .bar{fill:var(--blue)}.plot .bar.on{fill:var(--bump)}.ci{fill:#1f6fd0;fill-opacity:.14}"
    ".limit{stroke:var(--bad);stroke-width:1.5;stroke-dasharray:6 4}"
    ".hint{stroke:#8a96a1;stroke-width:1.5;stroke-dasharray:5 4}"
    ".plot .run{fill:#fff;fill-opacity:.75;stroke:var(--ink);stroke-width:1.6}"
    ".plot .best{fill:var(--bad);stroke:#fff;stroke-width:1.5}"
    ".contour{stroke:#33414e;stroke-width:1}.plot .level{font-size:12px;paint-order:stroke;"
    "stroke:#fff;stroke-width:3px;stroke-opacity:.8}\n"
    "ul.words{margin:0 0 14px;padding-left:20px}ul.words li{margin:3px 0;max-width:90ch}ul.words "
    "li.command{list-style:none;margin:6px 0 10px}"
    "ul.words code{padding:4px "
    "8px;background:#eef2f5;border-radius:6px;overflow-wrap:anywhere;user-select:all}"
    "tr.on td{font-weight:600}tr.total td{border-top:2px solid var(--line)}\n"
    ".answer{border-left:6px solid var(--blue);background:#eef5fd;border-radius:0 8px 8px 0;"
    "padding:12px 18px;margin:0 0 16px;break-inside:avoid}.answer h2{margin:0}.answer p{margin:6px "
    "0;max-width:90ch}.answer .set{font-size:22px;font-weight:650;margin:4px 0}.answer "
    "ul{margin:8px 0 0;padding-left:20px}.answer .doubt{font-size:inherit;margin:0}"
    ".plot path.outside{fill:#fff;fill-opacity:.66}.plot path.edge{stroke:var(--ink);"
    "stroke-width:1.8}"
    "table.sheet td{height:34px;vertical-align:middle}table.sheet td.blank{border:1px solid "
    "#9aa5b0;min-width:90px}tr.begins td{border-top:3px solid var(--ink)}"
    "@media(max-width:600px){.panels .plot{font-size:14px}}\n";

/* Pages of lots. */
static const char lot_style[] =
    ".dot{fill:var(--blue);fill-opacity:.4}.mapped{fill:var(--ink);fill-opacity:.6;stroke:#fff;"
    "stroke-width:.9}.signal{fill:var(--bad)}.column{fill:#cfe0f5}"
    ".plot .fit{stroke:var(--bump);stroke-width:2.5}.plot .curve{stroke:var(--blue);"
    "stroke-width:2.5}.plot .thin{stroke:#8a96a1}.plot .hypothesis{stroke:var(--soft);"
    "stroke-width:2;stroke-dasharray:7 5}.plot .key{fill:var(--soft)}"
    ".lots th,.lots td{padding:4px 7px}.lots td.words:not(:empty){min-width:0}"
    ".plot .end{text-anchor:end;fill:var(--soft)}.pair{display:grid;grid-template-columns:repeat("
    "auto-fit,minmax(min(300px,100%),1fr));gap:18px}.polar{max-width:520px;margin:0 auto}"
    ".plot .mark.group{fill:#fff;stroke:var(--ink);stroke-width:1.8px}.plot .mark.signal{fill:"
    "var(--bad);stroke:var(--bad);stroke-width:1px}.plot .mark.beyond-limit{stroke:var(--bad);"
    "stroke-width:2.2px}.verdict.process{font-weight:500}"
    ".tiles .good{background:#e7f4ec;border-left:5px solid var(--good)}.tiles .bad{background:"
    "#fdeaea;border-left:5px solid var(--bad)}.tiles .open{background:#fff4df;border-left:5px "
    "solid var(--open)}.tiles+.tiles{margin-top:-6px}ul.flags{margin-bottom:14px}"
    ".bearings{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(230px,100%),1fr));"
    "gap:12px 18px}.bearings .plot{font-size:22px}.bearings figcaption{text-align:center}"
    "section.part h1~h2{break-after:avoid}\n"
    /* Sections follow each other on paper; what belongs together stays together. */
    "@media print{.lots .verdict{font-size:9pt;padding:2px 6px;white-space:normal}section.part "
    "th,section.part td{white-space:normal}section.part "
    ":not(.lots)>table td "
    "i{white-space:nowrap}section.part "
    "td.words:not(:empty){min-width:0}table.sheet "
    "td.blank{min-width:60px}section.part{break-after:auto;padding:0 0 "
    "10mm;margin:0;border-radius:0}"
    "h1,h2,h3,header,h1+.note,h2+.note{break-after:avoid}.tiles,.reasons,ul.flags{break-inside:"
    "avoid}tr{break-inside:avoid}thead{display:table-header-group}tbody tr:nth-child(-n+2),tbody "
    "tr:nth-last-child(2){break-after:avoid}.bearings{grid-template-columns:"
    "1fr 1fr 1fr;gap:8px}.bearings figure{break-inside:avoid}figure .plot{max-height:82mm}"
    "p{orphans:3;widows:3}}\n";

/* The loop on scans. Colours that the colour-blind tell apart: purple and orange for the two sides
 * of a circle, blue, orange, green and pink for scans. */
static const char loop_style[] =
    "h2.first{margin-top:0}.tiles.four{grid-template-columns:repeat(4,1fr)}.say{font-size:17px;max-"
    "width:82ch;margin:4px 0 16px}"
    ".verdict.loop-clean{background:var(--good)}.verdict.loop-clean::before{content:\"✓ \"}"
    ".verdict.loop-explained,.verdict.loop-partly,.verdict.loop-unattributed{background:"
    "var(--open)}.verdict.loop-explained::before,.verdict.loop-partly::before{content:\"! \"}"
    ".verdict.loop-unattributed::before{content:\"? \"}.next.calm{border-left-color:var(--good);"
    "background:#edf7f1}"
    "h3{font-size:14px;margin:16px 0 4px;overflow-wrap:anywhere}th.w,td.w{text-align:left}"
    "td.path{white-space:normal;overflow-wrap:anywhere;min-width:140px}"
    ".doubt{color:var(--bad);font-weight:650;max-width:82ch;margin:0 0 14px}"
    ".nobreak{white-space:nowrap}figcaption b{color:var(--ink)}"
    ".tag{padding:1px 9px;border-radius:99px;font-size:12.5px;font-weight:600;background:#e8ecf0}"
    ".tag.found{background:#dcebfb;color:#0b4f9e}.tag.tied,.tag.open{background:#fff0d6;"
    "color:#7a4a00}.tag.absent{color:var(--soft)}\n"
    ".strip{stroke:#d3dae1;stroke-width:3}.bases{stroke:#16202a;stroke-width:1}"
    ".outwards{stroke:#5e3c99}.inwards{stroke:#e66101}.tips{stroke:#5b6875;stroke-width:.7}"
    ".plot .bar{stroke:var(--ink);stroke-width:3}.vectors .bump{text-anchor:middle;"
    "fill:var(--soft)}.key{font-weight:600}.outkey{color:#5e3c99}.inkey{color:#b34a00}"
    ".plot .noise{fill:#dfe4e9}.plot .beyond{fill:#e9edf1}.plot .reach{fill:#fff}.plot "
    "path.shape{fill:#1f6fd0;"
    "fill-opacity:.2}.effect{stroke:var(--bump);stroke-width:2.5}"
    ".still{stroke:#cfd6dd;stroke-width:.8}.moved{stroke:var(--bump);stroke-width:1}"
    ".dots{stroke-width:3;stroke-linecap:round;stroke-opacity:.3;stroke:var(--ink)}"
    "path.pale{stroke:#aeb8c2}.aside{stroke-opacity:.55}.mean{stroke-width:2}"
    "path.k0{stroke:#0072b2}path.k1{stroke:#d55e00}path.k2{stroke:#009e73}path.k3{stroke:#aa4499}"
    "path.k4{stroke:#5b6875}span.k0{color:#0072b2}span.k1{color:#c04f00}span.k2{color:#00795a}"
    "span.k3{color:#aa4499}span.k4{color:#5b6875}"
    "td.moved-on{background:#fff0d6;font-weight:650}th.group{text-align:center;border-left:1px "
    "solid var(--line)}details summary{cursor:pointer;font-weight:600;margin:14px 0 8px}"
    ".dimensions th,.dimensions td{padding:4px "
    "7px}.dimensions.narrow{width:auto}.dimensions{margin-bottom:14px}.plot.scale{font-size:13px}"
    ".dimensions td:first-child{position:sticky;left:0;background:#fff}"
    ".two{display:grid;grid-template-columns:1fr 1fr;gap:16px 22px;margin-bottom:14px}"
    "code{font-size:12.5px;overflow-wrap:anywhere}\n"
    "@media(max-width:600px){.two{grid-template-columns:minmax(0,1fr)}.two "
    ".plot{font-size:16px}.say{font-size:16px}}\n";

void fg_html_text(FILE *out, const char *text) {
  while (*text) {
    size_t length = fg_utf8_length(text);
    switch (*text) {
    case '<':
      fputs("&lt;", out);
      break;
    case '>':
      fputs("&gt;", out);
      break;
    case '&':
      fputs("&amp;", out);
      break;
    case '"':
      fputs("&quot;", out);
      break;
    case '\'':
      fputs("&#39;", out);
      break;
    default: {
      char visible[16];
      size_t count;
      fg_utf8_make_visible(text, length ? length : 1, true, visible, &count);
      fwrite(visible, 1, count, out);
    }
    }
    text += length ? length : 1;
  }
}

/* A page is one file: it fetches nothing, runs nothing, and sends nothing, whatever a name in it
 * says. Styles are inline, pictures are data. */
void fg_html_head(FILE *out, const char *title) {
  fputs("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
        "style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
        out);
  fg_html_text(out, title);
  fputs(" – foilgauge</title>\n", out);
}

void fg_html_style(FILE *out) {
  fprintf(out, "%s%s%s%s%s%s", style, judged_style, plot_style, lot_style, loop_style, print_style);
}

void fg_html_begin(FILE *out, const char *title) {
  fg_html_head(out, title);
  fputs("<style>\n", out);
  fg_html_style(out);
  fputs("</style>\n</head>\n<body>\n<main>\n", out);
}

void fg_html_end(FILE *out) {
  fputs("</main>\n</body>\n</html>\n", out);
}
